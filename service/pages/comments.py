"""Comments on source lines: the staff's forms on the submission page."""

from fastapi import APIRouter
from fastapi.responses import RedirectResponse, Response
from starlette.datastructures import FormData

from service.api import feedback
from service.api.submissions import Submission
from service.auth.forms import Form, field, required
from service.auth.roles import Staff
from service.http.errors import Problem
from service.http.state import Db
from service.store.course.comments import LONGEST

router = APIRouter()


@router.post("/submissions/{id}/comments")
async def create(person: Staff, form: Form, stored: Submission, database: Db) -> Response:
    """Write a comment on a line, and show it."""
    cell, line = _number(form, "cell"), _number(form, "line")
    await feedback.write_comment(database, person, stored, cell, line, required(form, "comment", LONGEST))
    return RedirectResponse(f"/submissions/{stored.id}#line-{cell}-{line}", 303)


@router.post("/submissions/{id}/comments/{comment}/delete")
async def delete(person: Staff, form: Form, stored: Submission, comment: str, database: Db) -> Response:
    """Delete a comment."""
    await feedback.delete_comment(database, person, stored, comment)
    return RedirectResponse(f"/submissions/{stored.id}#source", 303)


def _number(form: FormData, name: str) -> int:
    text = field(form, name)
    if not (text.isascii() and text.isdigit() and len(text) < 7):
        raise Problem(422, "invalid-request", f"the {name} must be a whole number", f"/{name}")
    return int(text)
