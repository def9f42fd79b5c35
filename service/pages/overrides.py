"""Score overrides: forms and list on the submission page."""

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
async def create(id: str, request: Request, person: Instructor, form: Form) -> Response:
    """Override the score of a check or of the whole submission, replacing an override in force for the
    same.
    """
    stored = await find_submission(request, id)
    check, points, revision = field(form, "check"), field(form, "points"), field(form, "seen")
    reason = field(form, "reason", overrides.LONGEST_REASON)
    if not (points.isascii() and points.isdigit() and len(points) < 5):
        raise Problem(422, "invalid-request", "points must be a whole number, 0 or more", "/points")
    seen = int(revision) if revision.isascii() and revision.isdigit() and len(revision) < 9 else None
    try:
        await overrides.give(
            request.app.state.database, stored.id, person.name, check=check or None, points=int(points), reason=reason, seen=seen
        )
    except overrides.OverrideRejected as error:
        raise _problem(error) from error
    return RedirectResponse(f"/submissions/{stored.id}#points", 303)


@router.post("/submissions/{id}/overrides/{override}/withdraw")
async def withdraw(id: str, override: str, request: Request, person: Instructor, form: Form) -> Response:
    """Withdraw an override, so that the measured score counts again."""
    stored = await find_submission(request, id)
    try:
        found = await overrides.withdraw(request.app.state.database, stored.id, identifier(override), person.name)
    except overrides.OverrideRejected as error:
        raise _problem(error) from error
    if not found:
        raise Problem(404, "not-found", "no override with this id: reload the page")
    return RedirectResponse(f"/submissions/{stored.id}#points", 303)


async def context(request: Request, stored: SubmissionRecord) -> dict[str, Any]:
    """Return the context of ``overrides.html`` for a submission."""
    found = await overrides.of_submission(request.app.state.database, stored.id)
    outcomes = stored.report.outcomes() if stored.report else []
    labels = {outcome.id: outcome.label for outcome in outcomes}
    counted = [(outcome.id, outcome.label, outcome.points) for outcome in outcomes if outcome.counted]
    return {"overrides": found, "overrides_revision": overrides.revision(found), "check_labels": labels, "checks_counted": counted}


def _problem(error: overrides.OverrideRejected) -> Problem:
    return Problem(STATUS[error.kind], error.kind, str(error))
