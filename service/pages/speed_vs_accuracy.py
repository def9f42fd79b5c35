"""The page of the reference methods: what accuracy costs, where methods fail, and the least model of a
scene.
"""

from typing import Annotated, Literal

from fastapi import APIRouter, Query, Request, Response
from fastapi.responses import HTMLResponse

from service.auth.roles import OptionalUser
from service.grading.figures import method_charts
from service.grading.figures.chart_drawing import draw
from service.http.errors import Problem
from service.http.templating import templates

router = APIRouter()


@router.get("/reference", response_class=HTMLResponse)
async def reference(
    request: Request, person: OptionalUser, scene: Annotated[int, Query(ge=0)] = 0
) -> HTMLResponse:
    """Show the cost of accuracy on one scene, where methods fail and the least models, with date and versions
    of the measurement.
    """
    document = method_charts.load()
    if scene >= method_charts.count(document, "cost"):
        raise Problem(404, "not-found", f"no scene {scene}: see /reference for the scenes")
    return templates.TemplateResponse(
        request,
        "reference.html",
        {"document": document, "number": scene, "exact_error": method_charts.EXACT_ERROR},
    )


@router.get("/reference/{kind}-{number}.svg")
async def chart(kind: Literal["cost", "failure"], number: int) -> Response:
    """Return a chart of the reference page as SVG."""
    document = method_charts.load()
    if not 0 <= number < method_charts.count(document, kind):
        raise Problem(404, "not-found", f"no chart {number}: see /reference for the charts")
    return Response(draw(method_charts.chart(document, kind, number)), media_type="image/svg+xml")
