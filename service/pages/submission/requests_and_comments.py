"""Feedback on a submission: regrade requests with their answers, the list of them, and the staff's comments
on source lines with the student's answers.
"""

from typing import get_args

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response
from starlette.datastructures import FormData

from service.api import requests_and_comments as feedback
from service.api.submissions import Assigned, Submission
from service.auth.forms import Form, field, required
from service.auth.roles import CurrentUser, Staff
from service.http.errors import Problem
from service.http.requests import identifier
from service.http.state import Db
from service.http.templating import templates
from service.pages.markdown import inline
from service.pages.regrades import check_labels
from service.pages.rejected_forms import post_form
from service.pages.submission import page
from service.store.course import comments, regrade_requests
from service.store.course.regrade_requests import Answer

router = APIRouter()
LIST = "/assignments/{slug}/regrade-requests"


@post_form(router, "/submissions/{id}/regrade-requests", page=page.report, at=page.PATH)
async def request_regrade(person: CurrentUser, form: Form, stored: Submission, database: Db) -> Response:
    """Request a regrade of a check of one's own submission, or of all of it."""
    reason = required(form, "reason", regrade_requests.LONGEST)
    await feedback.request_regrade(database, person, stored, reason, field(form, "check") or None)
    return RedirectResponse(f"/submissions/{stored.id}#regrade-requests", 303)


@router.get(LIST, response_class=HTMLResponse)
async def list_requests(request: Request, person: Staff, assignment: Assigned, database: Db) -> Response:
    """Show the regrade requests about an assignment, each open one with the form of its answer, and what
    students answered to comments.
    """
    rows = await regrade_requests.of_assignment(database, assignment.slug)
    return templates.TemplateResponse(
        request,
        "regrade_requests.html",
        {
            "assignment": assignment,
            "requests": rows,
            "comment_answers": await comments.latest_answers(database, assignment.slug),
            "labels": check_labels(assignment),
            "inline": inline,
        },
    )


@post_form(router, "/submissions/{id}/regrade-requests/{request}/answer", page=page.report, at=page.PATH)
@post_form(router, LIST + "/{request}/answer", page=list_requests, at=LIST)
async def answer_request(asked: Request, person: Staff, form: Form, request: str, database: Db) -> Response:
    """Accept or decline a request. Show the next open one of the assignment's list, or the submission if it
    was answered there.
    """
    status = next((one for one in get_args(Answer) if one == field(form, "status")), None)
    if status is None:
        raise Problem(422, "invalid-request", "accept or decline the request", "/status")
    found = await feedback.answer_request(
        database, person, request, status, required(form, "answer", regrade_requests.LONGEST)
    )
    slug = asked.path_params.get("slug")
    if slug is None:
        return RedirectResponse(f"/submissions/{found.submission}#regrade-requests", 303)
    first, *_ = await regrade_requests.of_assignment(database, slug)
    place = f"#request-{first.id}" if first.status == "open" else ""
    return RedirectResponse(f"{LIST.format(slug=slug)}{place}", 303)


@post_form(router, "/submissions/{id}/comments", page=page.report, at=page.PATH)
async def write_comment(person: Staff, form: Form, stored: Submission, database: Db) -> Response:
    """Write a comment on a line, and show it."""
    cell, line = _number(form, "cell"), _number(form, "line")
    await feedback.write_comment(
        database, person, stored, cell, line, required(form, "comment", comments.LONGEST)
    )
    return RedirectResponse(f"/submissions/{stored.id}#line-{cell}-{line}", 303)


@post_form(router, "/submissions/{id}/comments/{comment}/answer", page=page.report, at=page.PATH)
async def answer_comment(
    person: CurrentUser, form: Form, stored: Submission, comment: str, database: Db
) -> Response:
    """Write an answer below a comment, and show it."""
    found = await comments.of_submission(database, stored.id)
    answered = next((one for one in found if one.id == identifier(comment)), None)
    if answered is None:
        raise Problem(404, "not-found", "the comment was deleted: reload the page")
    cell, line = answered.cell, answered.line
    await feedback.write_comment(
        database, person, stored, cell, line, required(form, "answer", comments.LONGEST)
    )
    return RedirectResponse(f"/submissions/{stored.id}#line-{cell}-{line}", 303)


@post_form(router, "/submissions/{id}/comments/{comment}/delete", page=page.report, at=page.PATH)
async def delete_comment(
    person: Staff, form: Form, stored: Submission, comment: str, database: Db
) -> Response:
    """Delete a comment."""
    await feedback.delete_comment(database, person, stored, comment)
    return RedirectResponse(f"/submissions/{stored.id}#source", 303)


def _number(form: FormData, name: str) -> int:
    text = field(form, name)
    if not (text.isascii() and text.isdigit() and len(text) < 7):
        raise Problem(422, "invalid-request", f"the {name} must be a whole number", f"/{name}")
    return int(text)
