"""Server-sent events: the progress of a submission until its result is stored."""

from collections.abc import AsyncIterator
from typing import Annotated, Any

from fastapi import APIRouter, Header
from fastapi.sse import EventSourceResponse, ServerSentEvent

from service.api.figure_renderer import Renderer
from service.api.submissions import Submission
from service.http.live_updates import Listener
from service.http.openapi import PERSON, problems
from service.http.state import Held
from service.store.database import is_outage
from service.store.submissions.records import SubmissionRecord

router = APIRouter(tags=["Submissions"])
LONGEST_S = 3600.0


@router.get(
    "/v1/submissions/{id}/events",
    response_class=EventSourceResponse,
    responses=problems(PERSON | {404: "not-found"}),
)
async def events(
    stored: Submission,
    listener: Held[Listener],
    renderer: Held[Renderer],
    last_event_id: Annotated[str | None, Header(description="The last event that was received.")] = None,
) -> AsyncIterator[ServerSentEvent]:
    """Send ``queued`` with its position, ``running`` with scene k of n, then ``graded`` or ``faulted``, and
    close the stream.

    No event is sent during a database outage. A client reopens a stream that ends early, at any server of the
    installation. An event's id encodes its content, so a client that sends ``Last-Event-ID`` does not receive
    the same event twice.
    """
    sent = last_event_id
    renderer.prepare(stored.assignment)  # who waits for a report will look at its figures
    async for _ in listener.wait_for_changes(str(stored.id), LONGEST_S):
        try:
            progress = await _progress(stored, listener)
        except Exception as error:
            if not is_outage(error):
                raise
            continue
        id = " ".join(str(value) for value in progress.values())
        if id != sent:
            yield ServerSentEvent(event=progress["status"], id=id, data=progress)
            sent = id
        if progress["status"] in ("graded", "faulted"):
            return


async def _progress(stored: SubmissionRecord, listener: Listener) -> dict[str, Any]:
    row = await listener.state(stored.id)
    assert row is not None
    progress = {"status": row.status, "grading": row.number}
    if row.finished:
        if stored.withheld:
            return progress
        return progress | {"score": row.score, "max_score": row.max_score, "total": row.total}
    if row.status == "queued":
        return progress | {"position": await listener.position(str(row.grading))}
    return progress | {"phase": row.phase, "scene": row.scene, "scenes": row.scenes}
