"""The page of the reference methods: charts of speed vs accuracy, and of where methods fail."""

from typing import Literal

from fastapi import APIRouter, Request, Response
from fastapi.responses import HTMLResponse

from service.api.figure_renderer import Renderer
from service.auth.roles import OptionalUser
from service.grading import charts
from service.http.errors import Problem
from service.http.state import Held
from service.http.templating import templates

router = APIRouter()


@router.get("/reference", response_class=HTMLResponse)
async def reference(request: Request, person: OptionalUser) -> HTMLResponse:
    """Show speed and accuracy of the reference methods and where they fail, with date and versions of
    the measurement.
    """
    document, atlas = charts.load_work_precision(), charts.load_stability()
    context = {
        "document": document,
        "atlas": atlas,
        "scenes": charts.scenes(document),
        "accurate": charts.accurate(document),
        "cheaper": charts.cheaper(document),
    }
    return templates.TemplateResponse(request, "reference.html", context)


@router.get("/reference/{kind}/{number}.svg")
async def chart(
    kind: Literal["work-precision", "stability"], number: int, renderer: Held[Renderer]
) -> Response:
    """Return a chart of the reference page as SVG."""
    count = len(
        charts.load_stability()["entries"]
        if kind == "stability"
        else charts.scenes(charts.load_work_precision())
    )
    if not 0 <= number < count:
        raise Problem(404, "not-found", f"no chart {number}: see /reference for the charts")
    return Response(await renderer.chart(kind, number), media_type="image/svg+xml")
