"""Two pages to look at: the latest submissions, and one report with its figures."""

from pathlib import Path

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse
from fastapi.templating import Jinja2Templates
from jinja2 import Environment, FileSystemLoader, select_autoescape

from exercises.assignment import assignments
from service.routes import find_submission, status

router = APIRouter()
LATEST = 100
_environment = Environment(
    loader=FileSystemLoader(Path(__file__).parent / "templates"),
    autoescape=select_autoescape(),
    trim_blocks=True,
    lstrip_blocks=True,
)
_templates = Jinja2Templates(env=_environment)


@router.get("/", response_class=HTMLResponse)
async def index(request: Request) -> HTMLResponse:
    """The latest submissions and the assignments."""
    stored = await request.app.state.store.recent(LATEST)
    rows = [(s, status(request, s)) for s in stored]
    context = {"rows": rows, "assignments": list(assignments().values()), "walls": request.app.state.walls.name}
    return _templates.TemplateResponse(request, "index.html", context)


@router.get("/submissions/{id}", response_class=HTMLResponse)
@router.get("/v1/submissions/{id}/report.html", response_class=HTMLResponse)
async def report(id: str, request: Request) -> HTMLResponse:
    """One submission: its lines, causes, figures and animations."""
    stored = await find_submission(request, id)
    return _templates.TemplateResponse(request, "report.html", {"stored": stored, "status": status(request, stored)})
