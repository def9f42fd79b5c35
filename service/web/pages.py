"""Pages to look at: the latest submissions, one report with its figures, the charts of the reference methods."""

from pathlib import Path
from typing import Literal

from fastapi import APIRouter, Request, Response
from fastapi.responses import HTMLResponse
from fastapi.templating import Jinja2Templates
from jinja2 import Environment, FileSystemLoader, select_autoescape

from exercises.assignment import assignments
from service import charts
from service.store.reading import recent
from service.web.problems import Problem
from service.web.routes import find_submission

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
    database = request.app.state.database
    walls, refusal = await request.app.state.crew.known()
    context = {
        "rows": await recent(database, LATEST),
        "assignments": list(assignments().values()),
        "walls": walls or refusal or "none",
    }
    return _templates.TemplateResponse(request, "index.html", context)


@router.get("/reference", response_class=HTMLResponse)
async def reference(request: Request) -> HTMLResponse:
    """What the reference methods cost, how accurate they are and where they fail, with date and versions of the measurement."""
    document, atlas = charts.load_work_precision(), charts.load_stability()
    context = {"document": document, "atlas": atlas, "scenes": charts.scenes(document), "exceptions": charts.exceptions(document)}
    return _templates.TemplateResponse(request, "reference.html", context)


@router.get("/reference/{kind}/{number}.svg")
async def chart(kind: Literal["work-precision", "stability"], number: int, request: Request) -> Response:
    """A chart of that page."""
    known = len(charts.load_stability()["entries"] if kind == "stability" else charts.scenes(charts.load_work_precision()))
    if not 0 <= number < known:
        raise Problem(404, "not-found", f"there is no chart {number}")
    return Response(await request.app.state.draughtsman.chart(kind, number), media_type="image/svg+xml")


@router.get("/submissions/{id}", response_class=HTMLResponse)
@router.get("/v1/submissions/{id}/report.html", response_class=HTMLResponse)
async def report(id: str, request: Request) -> HTMLResponse:
    """One submission: its lines, causes, figures and animations."""
    stored = await find_submission(request, id)
    return _templates.TemplateResponse(request, "report.html", {"stored": stored})
