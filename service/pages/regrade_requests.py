"""Regrade requests: the student's form and the staff's answer on the submission page, and the list of an assignment."""

from typing import get_args

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response

from service.api import feedback
from service.api.submissions import Assigned, Submission
from service.auth.forms import Form, field, required
from service.auth.roles import CurrentUser, Staff
from service.http.errors import Problem
from service.http.state import Db
from service.http.templating import templates
from service.store.course import regrade_requests
from service.store.course.regrade_requests import LONGEST, Answer

router = APIRouter()


@router.post("/submissions/{id}/regrade-requests")
async def create(person: CurrentUser, form: Form, stored: Submission, database: Db) -> Response:
    """Request a regrade of one's own submission."""
    await feedback.request_regrade(database, person, stored, required(form, "reason", LONGEST))
    return RedirectResponse(f"/submissions/{stored.id}#regrade-requests", 303)


@router.get("/assignments/{slug}/regrade-requests", response_class=HTMLResponse)
async def list_requests(request: Request, person: Staff, assignment: Assigned, database: Db) -> Response:
    """Show the regrade requests about an assignment, each open one with the form of its answer."""
    rows = await regrade_requests.of_assignment(database, assignment.slug)
    return templates.TemplateResponse(request, "regrade_requests.html", {"assignment": assignment, "requests": rows})


@router.post("/regrade-requests/{request}/answer")
async def answer(person: Staff, form: Form, request: str, database: Db) -> Response:
    """Accept or decline a request, and show its submission."""
    status = next((one for one in get_args(Answer) if one == field(form, "status")), None)
    if status is None:
        raise Problem(422, "invalid-request", "accept or decline the request", "/status")
    found = await feedback.answer_request(database, person, request, status, required(form, "answer", LONGEST))
    return RedirectResponse(f"/submissions/{found.submission}#regrade-requests", 303)
