"""The reference page with its charts, and a student's submissions to an assignment."""

from typing import Literal

from fastapi import APIRouter, Request, Response
from fastapi.responses import HTMLResponse

from service.api.history import list_own
from service.api.submissions import find_assignment
from service.auth.identity import COOKIE
from service.auth.roles import CurrentUser
from service.grading import charts
from service.http.errors import Problem
from service.http.templating import templates

router = APIRouter()


@router.get("/reference", response_class=HTMLResponse)
async def reference(request: Request) -> HTMLResponse:
    """Show speed and accuracy of the reference methods and where they fail, with date and versions of
    the measurement.
    """
    document, atlas = charts.load_work_precision(), charts.load_stability()
    context = {"document": document, "atlas": atlas, "scenes": charts.scenes(document), "exceptions": charts.exceptions(document)}
    return templates.TemplateResponse(request, "reference.html", context)


@router.get("/reference/{kind}/{number}.svg")
async def chart(kind: Literal["work-precision", "stability"], number: int, request: Request) -> Response:
    """Return a chart of the reference page as SVG."""
    count = len(charts.load_stability()["entries"] if kind == "stability" else charts.scenes(charts.load_work_precision()))
    if not 0 <= number < count:
        raise Problem(404, "not-found", f"no chart {number}: see /reference for the charts")
    return Response(await request.app.state.renderer.chart(kind, number), media_type="image/svg+xml")


@router.get("/assignments/{slug}", response_class=HTMLResponse)
async def own_submissions(slug: str, request: Request, person: CurrentUser) -> Response:
    """Show the person's submissions to an assignment and the changes between them."""
    assignment = find_assignment(slug)
    history = await list_own(slug, request)
    by_id = {one["id"]: one for one in history["submissions"]}
    context = {"assignment": assignment, "person": person.name, "history": history}
    context |= {"best": by_id.get(history["best"]), "last": by_id.get(history["last"]), "session": COOKIE in request.cookies}
    return templates.TemplateResponse(request, "submissions.html", context)
