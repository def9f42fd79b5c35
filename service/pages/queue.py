"""The queue page for staff: running, waiting and failed gradings, and workers; with cancel and retry."""

from collections.abc import AsyncIterator
from typing import Annotated, Any

from fastapi import APIRouter, Header, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response
from fastapi.sse import EventSourceResponse, ServerSentEvent

from service.auth.forms import Form
from service.auth.roles import Staff
from service.http.errors import Problem
from service.http.live_updates import ChangeFeed
from service.http.requests import identifier
from service.http.state import Db, Held
from service.http.templating import templates
from service.pages.rejected_forms import post_form
from service.settings import LEASE_S
from service.store.database import Row
from service.store.queue import cancelling as gradings
from service.store.queue.overview import MOST_PLACES, QueueSnapshot, regrade

router = APIRouter()
Queue = Held[ChangeFeed[Any]]
LONG_S = 5.0  # time in one scene that suggests an endless loop; most scenes take a tenth of it
SILENT_S = 5.0  # workers send a heartbeat every three seconds


@router.get("/queue", response_class=HTMLResponse)
async def page(request: Request, person: Staff, queue: Queue) -> Response:
    """Show the queue."""
    return templates.TemplateResponse(
        request, "queue.html", {"queue": await queue.current(), "most": MOST_PLACES}
    )


@router.get("/queue/events", response_class=EventSourceResponse)
async def events(
    person: Staff, queue: Queue, last_event_id: Annotated[str | None, Header()] = None
) -> AsyncIterator[ServerSentEvent]:
    """Send an event whenever the page's data changes, at most once per second."""
    async for event in queue.events(last_event_id):
        yield event


@post_form(router, "/queue/{grading}/cancel", page=page, at="/queue")
async def cancel(grading: str, person: Staff, form: Form, database: Db, queue: Queue) -> Response:
    """Cancel a waiting or running grading. It does not count against the student."""
    try:
        found = await gradings.cancel(database, identifier(grading), person.name)
    except gradings.AlreadyFinished:
        raise Problem(
            409,
            "changed-meanwhile",
            "the grading already has a result and cannot be cancelled: reload the page",
        ) from None
    if found is None:
        raise Problem(404, "not-found", "no such grading: reload the queue")
    queue.invalidate()
    return RedirectResponse("/queue", 303)


@post_form(router, "/queue/{submission}/retry", page=page, at="/queue")
async def retry(submission: str, person: Staff, form: Form, database: Db, queue: Queue) -> Response:
    """Queue a new grading of a submission whose last one failed or was cancelled."""
    if not await regrade(database, [identifier(submission)], person.name, faults=True):
        raise Problem(
            409,
            "changed-meanwhile",
            "nothing to retry: the submission has a report, is being graded or does not exist; reload the"
            " queue",
        )
    queue.invalidate()
    return RedirectResponse("/queue", 303)


def snapshot(queue: QueueSnapshot, lease_s: float = LEASE_S) -> dict[str, Any]:
    """Return the data of the queue page.

    Times are rounded, so that the data does not change every second.
    """
    busy = {run.worker for run in queue.going}
    return {
        "total": queue.places[0].total if queue.places else 0,
        "kinds": [(kind.n, kind.kind) for kind in queue.waiting],
        "places": [row._asdict() for row in queue.places],
        "going": [_run_to_json(run, lease_s) for run in queue.going],
        "workers": [
            w._asdict() | {"silent_s": _silence(w.silent_s, SILENT_S), "busy": w.name in busy}
            for w in queue.workers
        ],
        "faults": [row._asdict() for row in queue.faults],
    }


def format_seconds(seconds: float) -> str:
    """Return a duration as text, rounded more coarsely the longer it is."""
    whole = max(0, int(seconds))
    for below, step in ((10, 1), (60, 5), (600, 30)):
        if whole < below:
            whole -= whole % step
            return f"{whole} s" if whole < 60 else f"{whole // 60} min {whole % 60} s"
    return f"{whole // 60} min"


def _silence(seconds: float, usual: float) -> str:
    return f"silent for {format_seconds(seconds)}" if seconds > usual else "responding"


def _run_to_json(run: Row, lease_s: float) -> dict[str, Any]:
    phase = f"{run.phase}, scene {run.scene} of {run.scenes}" if run.scenes else run.phase
    progress = {
        "phase": phase,
        "running": format_seconds(run.running_s),
        "in_scene": format_seconds(run.scene_s),
        "stuck": "",
    }
    progress["silent"] = _silence(run.silent_s, lease_s)
    if run.scene_s > LONG_S and run.phase in ("starting", "playing"):
        where = "in one scene" if run.scene else "before its first scene"
        progress["stuck"] = (
            f"{format_seconds(run.scene_s)} {where}: possibly an endless loop; the time limit will stop it"
        )
    columns = (
        "grading",
        "kind",
        "number",
        "preview",
        "submission",
        "person",
        "full_name",
        "assignment",
        "worker",
    )
    return {name: getattr(run, name) for name in columns} | progress
