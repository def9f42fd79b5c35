"""Score overrides: forms and list on the submission page."""

import re

from fastapi import APIRouter
from fastapi.responses import RedirectResponse, Response

from service.api.submissions import Submission
from service.auth.forms import Form, field
from service.auth.roles import Instructor
from service.formats.grade_row import whole
from service.http.errors import Problem
from service.http.requests import identifier
from service.http.state import Db
from service.pages.rejected_forms import post_form
from service.pages.submission import page
from service.store.course import overrides

router = APIRouter()
STATUS = {"invalid-request": 422, "not-ready": 409, "changed-meanwhile": 409}


@post_form(router, "/submissions/{id}/overrides", page=page.report, at=page.PATH)
async def create(person: Instructor, form: Form, stored: Submission, database: Db) -> Response:
    """Override the score of a check or of the whole submission, replacing an override in force for the
    same.
    """
    check, points, revision = field(form, "check"), field(form, "points"), field(form, "seen")
    reason = field(form, "reason", overrides.LONGEST_REASON)
    if not re.fullmatch(r"[0-9]{1,4}([.,][0-9]{1,2})?", points):
        raise Problem(
            422, "invalid-request", "points must be a number from 0 with at most two decimals", "/points"
        )
    seen = int(revision) if revision.isascii() and revision.isdigit() and len(revision) < 9 else None
    try:
        await overrides.give(
            database,
            stored.id,
            person.name,
            check=check or None,
            points=whole(float(points.replace(",", "."))),
            reason=reason,
            seen=seen,
        )
    except overrides.OverrideRejected as error:
        raise _problem(error) from error
    return RedirectResponse(f"/submissions/{stored.id}#points", 303)


@post_form(router, "/submissions/{id}/overrides/{override}/withdraw", page=page.report, at=page.PATH)
async def withdraw(
    person: Instructor, form: Form, stored: Submission, override: str, database: Db
) -> Response:
    """Withdraw an override, so that the measured score counts again."""
    try:
        found = await overrides.withdraw(database, stored.id, identifier(override), person.name)
    except overrides.OverrideRejected as error:
        raise _problem(error) from error
    if not found:
        raise Problem(404, "not-found", "no override with this id: reload the page")
    return RedirectResponse(f"/submissions/{stored.id}#points", 303)


def _problem(error: overrides.OverrideRejected) -> Problem:
    return Problem(STATUS[error.kind], error.kind, str(error), error.pointer)
