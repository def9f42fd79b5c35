"""API v1: regrade requests of students, with the staff's answers, and comments on source lines."""

from dataclasses import asdict
from typing import Annotated

from fastapi import APIRouter, Depends, Response
from pydantic import BaseModel, Field, StringConstraints

from polhode.report.student_line import BREAK
from service.api import response_models
from service.api.submissions import Assigned, Submission
from service.auth.identity import STAFF, Person, Reader, Submitter
from service.http.errors import Problem
from service.http.openapi import PERSON, problems
from service.http.requests import SmallBody, identifier
from service.http.state import Db
from service.store.course import comments, regrade_requests
from service.store.course.comments import Comment
from service.store.course.regrade_requests import RegradeRequest, RequestRejected
from service.store.submissions.records import SubmissionRecord

router = APIRouter(route_class=SmallBody, tags=["Feedback"])
STORED = PERSON | {404: "not-found"}
SENT = STORED | {408: "timed-out", 413: "too-large", 422: "invalid-request"}


def text(most: int) -> StringConstraints:
    """Return the constraints of a text that PostgreSQL can hold, of 1 to ``most`` characters."""
    return StringConstraints(strip_whitespace=True, min_length=1, max_length=most, pattern=r"^[^\x00]*$")


class NewRequest(BaseModel, extra="forbid"):
    """Why a check, or without one the whole submission, deserves more points."""

    check: Annotated[str, text(100)] | None = None
    reason: Annotated[str, text(regrade_requests.LONGEST)]


class NewAnswer(BaseModel, extra="forbid"):
    """The decision and its explanation."""

    status: regrade_requests.Answer
    answer: Annotated[str, text(regrade_requests.LONGEST)]


class NewComment(BaseModel, extra="forbid"):
    """A comment on a line of a code cell, both counted from 1."""

    cell: Annotated[int, Field(ge=1)] = 1
    line: Annotated[int, Field(ge=1)]
    comment: Annotated[str, text(comments.LONGEST)]


def _staff(person: Person) -> Person:
    if person.role not in STAFF:
        raise Problem(403, "not-allowed", "you don't have permission: only course staff can do this")
    return person


async def _reading_staff(person: Reader) -> Person:
    return _staff(person)


async def _writing_staff(person: Submitter) -> Person:
    return _staff(person)


ReadingStaff = Annotated[Person, Depends(_reading_staff)]
WritingStaff = Annotated[Person, Depends(_writing_staff)]


@router.get("/v1/submissions/{id}/regrade-requests", responses=problems(STORED))
async def list_requests(stored: Submission, database: Db) -> list[response_models.RegradeRequest]:
    """Return the regrade requests about a submission, oldest first."""
    return [_request(one) for one in await regrade_requests.of_submission(database, stored.id)]


@router.post(
    "/v1/submissions/{id}/regrade-requests",
    status_code=201,
    responses=problems(SENT | {409: ("changed-meanwhile", "not-ready")}),
)
async def create_request(
    person: Submitter, stored: Submission, body: NewRequest, database: Db
) -> response_models.RegradeRequest:
    """Request a regrade of one's own submission."""
    return _request(await request_regrade(database, person, stored, body.reason, body.check))


@router.get(
    "/v1/assignments/{slug}/regrade-requests",
    responses=problems(STORED | {503: ("assignment-broken", "busy")}),
)
async def list_of_assignment(
    person: ReadingStaff, assignment: Assigned, database: Db
) -> list[response_models.ListedRegradeRequest]:
    """Return the latest 500 regrade requests about an assignment to the course staff, open ones first."""
    rows = await regrade_requests.of_assignment(database, assignment.slug)
    return [response_models.ListedRegradeRequest(**row._asdict()) for row in rows]


@router.post("/v1/regrade-requests/{request}/answer", responses=problems(SENT | {409: "changed-meanwhile"}))
async def create_answer(
    person: WritingStaff, request: str, body: NewAnswer, database: Db
) -> response_models.RegradeRequest:
    """Accept or decline an open regrade request. This does not change points: override them, or regrade."""
    return _request(await answer_request(database, person, request, body.status, body.answer))


@router.get("/v1/submissions/{id}/comments", responses=problems(STORED))
async def list_comments(stored: Submission, database: Db) -> list[response_models.Comment]:
    """Return the comments on a submission in the order of its lines."""
    return [_comment(one) for one in await comments.of_submission(database, stored.id)]


@router.post("/v1/submissions/{id}/comments", status_code=201, responses=problems(SENT))
async def create_comment(
    person: Submitter, stored: Submission, body: NewComment, database: Db
) -> response_models.Comment:
    """Write a comment on a line of a submission, which the student can read. The student who submitted can
    answer on a line that has a comment.
    """
    return _comment(await write_comment(database, person, stored, body.cell, body.line, body.comment))


@router.delete(
    "/v1/submissions/{id}/comments/{comment}",
    status_code=204,
    responses=problems(STORED | {413: "too-large"}),
)
async def remove_comment(person: WritingStaff, stored: Submission, comment: str, database: Db) -> Response:
    """Delete a comment or a student's answer; the audit log keeps its text."""
    await delete_comment(database, person, stored, comment)
    return Response(status_code=204)


async def request_regrade(
    database: Db, person: Person, stored: SubmissionRecord, reason: str, check: str | None
) -> RegradeRequest:
    """Store a request about a check, or the whole submission. Raises Problem 403 unless ``person`` submitted,
    422 if the report has no such check, and 409 without a report or with an open request.
    """
    if stored.person != person.name:
        raise Problem(
            403,
            "not-allowed",
            "you don't have permission: only the student who submitted can request a regrade",
        )
    exercises = stored.report.exercises if stored.report else []
    if check is not None and exercises and all(o.id != check for e in exercises for o in e.outcomes):
        raise Problem(422, "invalid-request", f"the report has no check {check}: choose another", "/check")
    try:
        return await regrade_requests.request(database, stored.id, person.name, reason, check)
    except RequestRejected as error:
        raise Problem(409, error.kind, str(error)) from None


async def answer_request(
    database: Db, person: Person, request: str, status: regrade_requests.Answer, answer: str
) -> RegradeRequest:
    """Answer a request. Raises Problem 404 if there is none with that id,
    and 409 if it is answered already.
    """
    try:
        found = await regrade_requests.answer(database, identifier(request), person.name, status, answer)
    except RequestRejected as error:
        raise Problem(409, error.kind, str(error)) from None
    if found is None:
        raise Problem(404, "not-found", "no regrade request with this id: reload the page")
    return found


async def write_comment(
    database: Db, person: Person, stored: SubmissionRecord, cell: int, line: int, comment: str
) -> Comment:
    """Store a comment. Raises Problem 422 if the submission has no such line or too many comments, and 403
    unless ``person`` is of the staff, or submitted and answers on a line with a comment.
    """
    earlier = await comments.of_submission(database, stored.id)
    if person.role not in STAFF and all((one.cell, one.line) != (cell, line) for one in earlier):
        raise Problem(
            403,
            "not-allowed",
            "you don't have permission: only the course staff can comment on a line that has no comment",
        )
    if len(earlier) >= comments.MOST:
        raise Problem(
            422,
            "invalid-request",
            f"the submission has {comments.MOST} comments already: the course staff must delete some first",
        )
    cells = stored.submission.cells()
    if not 1 <= cell <= len(cells):
        raise Problem(
            422,
            "invalid-request",
            f"the submission has no code cell {cell}: its last one is {len(cells)}",
            "/cell",
        )
    lines = len(BREAK.sub("\n", cells[cell - 1].source).removesuffix("\n").split("\n"))
    if not 1 <= line <= lines:
        raise Problem(
            422,
            "invalid-request",
            f"{cells[cell - 1].name} has no line {line}: its last one is {lines}",
            "/line",
        )
    return await comments.write(database, stored.id, person.name, cell=cell, line=line, comment=comment)


async def delete_comment(database: Db, person: Person, stored: SubmissionRecord, comment: str) -> None:
    """Delete a comment. Raises Problem 404 if the submission has none with that id."""
    if not await comments.delete(database, stored.id, identifier(comment), person.name):
        raise Problem(404, "not-found", "no comment with this id: reload the page")


def _request(one: RegradeRequest) -> response_models.RegradeRequest:
    return response_models.RegradeRequest(**asdict(one))


def _comment(one: Comment) -> response_models.Comment:
    return response_models.Comment(**asdict(one))
