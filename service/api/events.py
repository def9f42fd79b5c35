"""Server-sent events: how far a submission is, from whichever worker grades it, until its result is there."""

from collections.abc import AsyncIterator
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Header, Request
from fastapi.sse import EventSourceResponse, ServerSentEvent

from service.api.submissions import find_submission
from service.http.live import Listener
from service.store import records
from service.store.database import is_outage
from service.store.records import SubmissionRecord

router = APIRouter()
LONGEST_S = 3600.0


@router.get("/v1/submissions/{id}/events", response_class=EventSourceResponse)
async def events(
    request: Request,
    stored: Annotated[SubmissionRecord, Depends(find_submission)],
    last_event_id: Annotated[str | None, Header()] = None,
) -> AsyncIterator[ServerSentEvent]:
    """``queued`` with its position, ``running`` with scene k of n, at last ``graded`` or ``faulted``: then the stream ends.

    While the database is out nothing is told. A stream that ends before is to be opened again, at whichever server there is: an
    event's id is what it tells, so who comes back with ``Last-Event-ID`` is not told the same twice.
    """
    told, listener = last_event_id, request.app.state.listener
    async for _ in listener.wait_for_changes(str(stored.id), LONGEST_S):
        try:
            now = await _now(request, stored, listener)
        except Exception as error:
            if not is_outage(error):
                raise
            continue
        id = " ".join(str(value) for value in now.values())
        if id != told:
            yield ServerSentEvent(event=now["status"], id=id, data=now | {"grading": now["attempt"]})
            told = id
        if now["status"] in ("graded", "faulted"):
            return


async def _now(request: Request, stored: SubmissionRecord, listener: Listener) -> dict[str, Any]:
    row = await records.state(request.app.state.database, stored.id)
    assert row is not None
    told = {"status": row.status, "attempt": row.number}
    if row.finished:
        return told | {"score": row.score, "max_score": row.max_score, "total": row.total}
    if row.status == "queued":
        return told | {"position": await listener.position(str(row.grading))}
    return told | {"phase": row.phase, "scene": row.scene, "scenes": row.scenes}
