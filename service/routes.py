"""The HTTP interface, version 1: assignments, submissions, reports and pictures."""

import re
import secrets
import uuid
from concurrent.futures.process import BrokenProcessPool
from datetime import UTC, datetime
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Header, Request, Response
from fastapi.responses import JSONResponse, PlainTextResponse

from exercises.assignment import Assignment, assignments
from service import intake
from service.grader import Grader
from service.grading.pictures import FORMATS
from service.grading.pictures import find as find_figure
from service.grading.sweep import NotSwept
from service.problems import Problem
from service.sandbox.seen import Fault
from service.store.store import KeyReused, Listed, Store, Stored

router = APIRouter()
LONGEST_WAIT_S = 60.0


@router.get("/livez")
async def livez() -> dict[str, str]:
    """The process is alive."""
    return {"status": "alive"}


@router.get("/readyz")
async def readyz(request: Request) -> JSONResponse:
    """Whether submissions can be graded, and what was checked."""
    grader = _grader(request)
    checks = {"walls": grader.refusal or grader.walls, "database": "ok"}
    try:
        await _store(request).ping()
    except Exception as error:
        checks["database"] = f"{type(error).__name__}"
    if grader.refusal or checks["database"] != "ok":
        return JSONResponse({"status": "not ready", "checks": checks}, 503, {"Retry-After": "5"})
    return JSONResponse({"status": "ready", "checks": checks})


@router.get("/v1/assignments")
async def list_assignments() -> list[dict[str, str]]:
    """Slug, title and version of every assignment."""
    return [{"slug": a.slug, "title": a.title, "version": a.version} for a in assignments().values()]


@router.get("/v1/assignments/{slug}")
async def show_assignment(slug: str) -> dict[str, Any]:
    """Exercises with their entry points and checks, each with its tolerance and the reason for it, and whether it is hidden."""
    assignment = find_assignment(slug)
    sections = [
        {
            "number": e.number,
            "title": e.title,
            "functions": list(e.functions),
            "optional": list(e.optional),
            "checks": [
                {
                    "id": c.id,
                    "label": c.label,
                    "hidden": assignment.hidden(c),
                    "tolerance": c.tolerance.model_dump(exclude_none=True),
                }
                for c in e.checks
            ],
        }
        for e in assignment.exercises
    ]
    return {"slug": slug, "title": assignment.title, "version": assignment.version, "exercises": sections}


@router.post("/v1/assignments/{slug}/submissions", status_code=202)
async def submit(
    slug: str,
    request: Request,
    prefer: Annotated[str | None, Header()] = None,
    idempotency_key: Annotated[str | None, Header(max_length=200)] = None,
) -> JSONResponse:
    """Store a submission, then grade it: 202 at once, or with ``Prefer: wait=SECONDS`` 200 if it is done in time."""
    assignment = find_assignment(slug)
    if refusal := _grader(request).refusal:
        raise Problem(503, "no-walls", f"submissions cannot be shut in here, so none is taken: {refusal}")
    received = await intake.receive(request, assignment)
    new = Stored(
        id=uuid.uuid4(),
        assignment=slug,
        submission=received.submission,
        exercises=received.exercises,
        seed=secrets.randbits(48),
        submitted_at=datetime.now(UTC),
    )
    try:
        stored = await _store(request).add(new, idempotency_key or None)
    except KeyReused:
        raise Problem(422, "key-reused", "the key came with another body before: use a new one") from None
    if not stored.finished:
        _grader(request).take(stored.id)
        await _grader(request).wait(stored.id, _seconds(prefer))
        stored = await _store(request).get(stored.id) or stored
    location = f"/v1/submissions/{stored.id}"
    if stored.finished and _seconds(prefer) > 0:
        return JSONResponse(_document(request, stored), 200, {"Location": location})
    return JSONResponse(_document(request, stored), 202, {"Location": location, "Retry-After": "1"})


@router.get("/v1/submissions/{id}")
async def show_submission(id: str, request: Request) -> dict[str, Any]:
    """Status of a submission, and its report once there is one."""
    return _document(request, await find_submission(request, id))


@router.get("/v1/submissions/{id}/report.txt")
async def report_text(id: str, request: Request) -> PlainTextResponse:
    """The report as the notebook prints it."""
    stored = await find_submission(request, id)
    if stored.report is None:
        raise Problem(409, "not-ready", stored.fault or "the submission has not been graded yet")
    return PlainTextResponse(stored.report.text())


@router.get("/v1/submissions/{id}/figures/{name}.{form}")
async def figure(id: str, name: str, form: Literal["png", "svg"], request: Request) -> Response:
    """A figure of the report, drawn when first asked for and kept."""
    stored = await find_submission(request, id)
    known = {f.name for f in stored.report.figures} if stored.report else set()
    if name not in known or find_figure(find_assignment(stored.assignment), name) is None:
        raise Problem(404, "not-found", f"the report has no figure {name[:80]}")
    kept = f"figures/{name}.{form}"
    if (found := await _store(request).artefact(stored.id, kept)) is None:
        packed = await _store(request).artefact(stored.id, "arrays.npz")
        if packed is None:
            raise Problem(404, "not-found", "the arrays of this submission are gone")
        try:
            content = await _grader(request).draw(stored, name, packed[0], form)
        except (ArithmeticError, ValueError) as error:
            raise Problem(404, "not-found", f"these numbers cannot be drawn: {error}") from error
        await _store(request).keep(stored.id, kept, content)
        found = await _store(request).artefact(stored.id, kept)
        assert found is not None
    return _cached(request, found, FORMATS[form])


@router.get("/v1/submissions/{id}/sweep.{form}")
async def speed_against_accuracy(id: str, form: Literal["json", "svg"], request: Request) -> Response:
    """Speed against accuracy of the submission's own function, played when first asked for and kept."""
    stored, store = await find_submission(request, id), _store(request)
    if not stored.finished:
        raise Problem(409, "not-ready", "the submission has not been graded yet")
    if (found := await store.artefact(stored.id, f"sweep.{form}")) is None:
        if refused := await store.artefact(stored.id, "sweep.refused"):
            raise Problem(404, "not-found", f"this function could not be swept: {refused[0].decode()}")
        try:
            document, chart = await _grader(request).sweep(stored)
        except NotSwept as reason:
            await store.keep(stored.id, "sweep.refused", str(reason).encode())
            raise Problem(404, "not-found", f"this function could not be swept: {reason}") from reason
        except (Fault, BrokenProcessPool) as error:
            raise Problem(503, "fault", "the sweep failed on our side: ask again later") from error
        await store.keep(stored.id, "sweep.json", document.encode())
        await store.keep(stored.id, "sweep.svg", chart)
        found = await store.artefact(stored.id, f"sweep.{form}")
        assert found is not None
    return _cached(request, found, FORMATS.get(form, "application/json"))


@router.get("/v1/submissions/{id}/animations/{name}.png")
async def animation(id: str, name: str, request: Request) -> Response:
    """The contact sheet of an animation."""
    stored = await find_submission(request, id)
    known = {a.name for a in stored.report.animations} if stored.report else set()
    found = await _store(request).artefact(stored.id, f"animations/{name}.png") if name in known else None
    if found is None:
        raise Problem(404, "not-found", f"the report has no animation {name[:80]}")
    return _cached(request, found, FORMATS["png"])


def find_assignment(slug: str) -> Assignment:
    """The assignment, or a 404 problem."""
    if (assignment := assignments().get(slug)) is None:
        raise Problem(404, "not-found", f"there is no assignment {slug[:80]}")
    return assignment


async def find_submission(request: Request, id: str) -> Stored:
    """The submission, or a 404 problem."""
    try:
        stored = await _store(request).get(uuid.UUID(id))
    except ValueError:
        stored = None
    if stored is None:
        raise Problem(404, "not-found", f"there is no submission {id[:80]}")
    return stored


def status(request: Request, stored: Stored | Listed) -> str:
    """queued, running, graded or faulted."""
    if stored.finished:
        return "graded" if stored.fault is None else "faulted"
    return "running" if stored.id in _grader(request).running else "queued"


def _document(request: Request, stored: Stored) -> dict[str, Any]:
    report = stored.report.model_dump(mode="json") if stored.report else None
    document = {"id": str(stored.id), "status": status(request, stored), "submitted_at": stored.submitted_at.isoformat()}
    return document | {"report": report} | ({"fault": stored.fault} if stored.fault else {})


def _cached(request: Request, found: tuple[bytes, str], media_type: str) -> Response:
    content, digest = found
    headers = {"ETag": f'"{digest}"', "Cache-Control": "private, max-age=31536000, immutable"}
    wanted = {tag.strip().removeprefix("W/") for tag in request.headers.get("if-none-match", "").split(",")}
    if wanted & {headers["ETag"], "*"}:
        return Response(status_code=304, headers=headers)
    return Response(content, media_type=media_type, headers=headers)


def _seconds(prefer: str | None) -> float:
    wanted = re.search(r"\bwait=(\d{1,9})\b", prefer or "")
    return min(float(wanted[1]), LONGEST_WAIT_S) if wanted else 0.0


def _store(request: Request) -> Store:
    store: Store = request.app.state.store
    return store


def _grader(request: Request) -> Grader:
    grader: Grader = request.app.state.grader
    return grader
