"""The live queue: what waits and what runs, on which worker, and what failed; staff may cancel and try again."""

from collections.abc import AsyncIterator
from typing import Annotated, Any
from uuid import UUID

from fastapi import APIRouter, Header, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response
from fastapi.sse import EventSourceResponse, ServerSentEvent
from sqlalchemy import Row

from service.auth.forms import Form
from service.auth.roles import Staff
from service.http.errors import Problem
from service.http.templating import templates
from service.settings import LEASE_S
from service.store import gradings
from service.store.queue_overview import MOST_PLACES, QueueSnapshot, regrade

router = APIRouter()
LONG_S = 5.0  # in one scene: most take a tenth of that
LEFT_S = 5.0  # a worker gives a sign of life every three seconds


@router.get("/queue", response_class=HTMLResponse)
async def page(request: Request, person: Staff) -> Response:
    """The queue as it is."""
    return templates.TemplateResponse(request, "queue.html", {"queue": await request.app.state.queue.now(), "most": MOST_PLACES})


@router.get("/queue/events", response_class=EventSourceResponse)
async def events(
    request: Request, person: Staff, last_event_id: Annotated[str | None, Header()] = None
) -> AsyncIterator[ServerSentEvent]:
    """An event whenever the page would show something else, at most one per second."""
    async for event in request.app.state.queue.events(last_event_id):
        yield event


@router.post("/queue/{grading}/cancel")
async def cancel(grading: str, request: Request, person: Staff, form: Form) -> Response:
    """Take a grading out of the queue, or stop its worker; it costs its person nothing."""
    try:
        found = await gradings.cancel(request.app.state.database, identifier(grading), person.name)
    except gradings.AlreadyFinished:
        raise Problem(409, "changed-meanwhile", "there is nothing to cancel: it has its result already") from None
    if found is None:
        raise Problem(404, "not-found", "there is no such grading")
    request.app.state.queue.changed()
    return RedirectResponse("/queue", 303)


@router.post("/queue/{submission}/retry")
async def retry(submission: str, request: Request, person: Staff, form: Form) -> Response:
    """Grade again what has no report: a fault of ours, or what was cancelled."""
    if not await regrade(request.app.state.database, [identifier(submission)], person.name, faults=True):
        raise Problem(409, "changed-meanwhile", "there is nothing to try again: it has a report, is being graded, or is not there")
    request.app.state.queue.changed()
    return RedirectResponse("/queue", 303)


def identifier(told: str) -> UUID:
    """The id in an address, or a 404 problem."""
    try:
        return UUID(told)
    except ValueError:
        raise Problem(404, "not-found", f"there is nothing by the id {told[:80]}") from None


def snapshot(queue: QueueSnapshot, lease_s: float = LEASE_S) -> dict[str, Any]:
    """The queue as the page shows it; times are rounded, so that it does not change all the time."""
    busy = {run.worker for run in queue.going}
    return {
        "total": queue.places[0].total if queue.places else 0,
        "kinds": [(kind.n, kind.kind) for kind in queue.waiting],
        "places": [row._asdict() for row in queue.places],
        "going": [_going(run, lease_s) for run in queue.going],
        "workers": [w._asdict() | {"silent_s": _silence(w.silent_s, LEFT_S), "busy": w.name in busy} for w in queue.workers],
        "faults": [row._asdict() for row in queue.faults],
    }


def format_seconds(seconds: float) -> str:
    """A time in words, the longer the rounder."""
    whole = max(0, int(seconds))
    for below, step in ((10, 1), (60, 5), (600, 30)):
        if whole < below:
            whole -= whole % step
            return f"{whole} s" if whole < 60 else f"{whole // 60} min {whole % 60} s"
    return f"{whole // 60} min"


def _silence(seconds: float, usual: float) -> str:
    return f"silent for {format_seconds(seconds)}" if seconds > usual else "alive"


def _going(run: Row[Any], lease_s: float) -> dict[str, Any]:
    phase = f"{run.phase}, scene {run.scene} of {run.scenes}" if run.scenes else run.phase
    told = {"phase": phase, "running": format_seconds(run.running_s), "in_scene": format_seconds(run.scene_s), "stuck": ""}
    told["silent"] = _silence(run.silent_s, lease_s)
    if run.scene_s > LONG_S and run.phase in ("starting", "playing"):
        where = "in one scene" if run.scene else "before its first scene"
        told["stuck"] = f"{format_seconds(run.scene_s)} {where}: perhaps an endless loop; its budget ends it"
    kept = ("grading", "kind", "number", "preview", "submission", "person", "assignment", "worker")
    return {name: getattr(run, name) for name in kept} | told
