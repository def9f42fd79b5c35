"""Points that an instructor gives by hand: forms on the page of a submission, and what everybody reads there about them."""

from typing import Any

from fastapi import APIRouter, Request
from fastapi.responses import RedirectResponse, Response

from service.api.submissions import find_submission
from service.auth.forms import Form, field
from service.auth.roles import Instructor
from service.http.errors import Problem
from service.pages.queue import identifier
from service.store.course import overrides
from service.store.records import SubmissionRecord

router = APIRouter()
STATUS = {"invalid-request": 422, "not-ready": 409, "changed-meanwhile": 409}


@router.post("/submissions/{id}/overrides")
async def give(id: str, request: Request, person: Instructor, form: Form) -> Response:
    """Give points for a check or for the whole submission, with a reason; they replace those in force for the same."""
    stored = await find_submission(request, id)
    check, points, seen = field(form, "check"), field(form, "points"), field(form, "seen")
    reason = field(form, "reason", overrides.LONGEST_REASON)
    if not (points.isascii() and points.isdigit() and len(points) < 5):
        raise Problem(422, "invalid-request", "points are a whole number from 0 on", "/points")
    known = int(seen) if seen.isascii() and seen.isdigit() and len(seen) < 9 else None
    try:
        await overrides.give(
            request.app.state.database, stored.id, person.name, check=check or None, points=int(points), reason=reason, seen=known
        )
    except overrides.OverrideRejected as why:
        raise _problem(why) from why
    return RedirectResponse(f"/submissions/{stored.id}#points", 303)


@router.post("/submissions/{id}/overrides/{override}/withdraw")
async def withdraw(id: str, override: str, request: Request, person: Instructor, form: Form) -> Response:
    """Let what was measured count again."""
    stored = await find_submission(request, id)
    try:
        found = await overrides.withdraw(request.app.state.database, stored.id, identifier(override), person.name)
    except overrides.OverrideRejected as why:
        raise _problem(why) from why
    if not found:
        raise Problem(404, "not-found", "there is nothing by this id to withdraw")
    return RedirectResponse(f"/submissions/{stored.id}#points", 303)


async def context(request: Request, stored: SubmissionRecord) -> dict[str, Any]:
    """What ``overrides.html`` shows of a submission."""
    given = await overrides.of_submission(request.app.state.database, stored.id)
    outcomes = stored.report.outcomes() if stored.report else []
    labels = {outcome.id: outcome.label for outcome in outcomes}
    counted = [(outcome.id, outcome.label) for outcome in outcomes if outcome.counted]
    return {"overrides": given, "overrides_stamp": overrides.revision(given), "check_labels": labels, "checks_counted": counted}


def _problem(why: overrides.OverrideRejected) -> Problem:
    return Problem(STATUS[why.kind], why.kind, str(why))
