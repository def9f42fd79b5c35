"""Pages to look at: the latest submissions, and the charts of the reference methods."""

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
    """What the reference methods cost, how accurate they are and where they fail, with date and versions of the measurement."""
    document, atlas = charts.load_work_precision(), charts.load_stability()
    context = {"document": document, "atlas": atlas, "scenes": charts.scenes(document), "exceptions": charts.exceptions(document)}
    return templates.TemplateResponse(request, "reference.html", context)


@router.get("/reference/{kind}/{number}.svg")
async def chart(kind: Literal["work-precision", "stability"], number: int, request: Request) -> Response:
    """A chart of that page."""
    known = len(charts.load_stability()["entries"] if kind == "stability" else charts.scenes(charts.load_work_precision()))
    if not 0 <= number < known:
        raise Problem(404, "not-found", f"there is no chart {number}")
    return Response(await request.app.state.renderer.chart(kind, number), media_type="image/svg+xml")


@router.get("/assignments/{slug}", response_class=HTMLResponse)
async def attempts(slug: str, request: Request, person: CurrentUser) -> Response:
    """What you have sent so far for an assignment, and what changed from one to the next."""
    assignment = find_assignment(slug)
    told = await list_own(slug, request)
    by_id = {one["id"]: one for one in told["submissions"]}
    context = {"assignment": assignment, "person": person.name, "told": told}
    context |= {"best": by_id.get(told["best"]), "last": by_id.get(told["last"]), "session": COOKIE in request.cookies}
    return templates.TemplateResponse(request, "attempts.html", context)
