"""The first page: for staff the course with what waits to be done, for a student their own submissions."""

from fastapi import APIRouter, Request, Response
from fastapi.responses import HTMLResponse

from exercises.assignment import assignments
from service.store import gradebook
from service.store.reading import recent
from service.web.identity import STAFF
from service.web.roles import Looking
from service.web.templating import templates

router = APIRouter()
LATEST = 100


@router.get("/", response_class=HTMLResponse)
async def index(request: Request, person: Looking) -> Response:
    """The assignments with their totals, and the latest submissions, of everybody or your own."""
    database, everybody = request.app.state.database, request.state.role in STAFF
    walls, refusal = await request.app.state.crew.known()
    context = {
        "everybody": everybody,
        "rows": await recent(database, LATEST, None if everybody else person.name),
        "assignments": assignments(),
        "overview": await gradebook.overview(database),
        "walls": walls or refusal or "none",
    }
    return templates.TemplateResponse(request, "index.html", context)
