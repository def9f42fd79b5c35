"""API v1: assignments, submissions and their reports."""

import asyncio
import re
import secrets
import time
import uuid
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Header, Request
from fastapi.responses import JSONResponse, PlainTextResponse, Response

from exercises.authoring.assignments import packages
from exercises.authoring.assignments.assignment import Assignment, NoAssignment
from exercises.authoring.assignments.catalogue import assignments, find
from exercises.authoring.importing.reported_lines import is_self_reported
from polhode.client import kit_hash as kit
from polhode.report.dataclass_json import document
from polhode.report.report import Report
from service.api import parse_submission, response_models
from service.api.health import WorkerStatus
from service.api.visible_results import NOT_RELEASED, visible
from service.auth.identity import STAFF, Person, Reader, Submitter, Visitor
from service.auth.roles import OptionalUser
from service.formats import junit
from service.grading.graded_file import GradedFile
from service.http.errors import Problem
from service.http.live_updates import Listener
from service.http.openapi import PERSON, Kinds, also, media, problems
from service.http.requests import identifier
from service.http.state import Config, Db, Held
from service.http.templating import ZONE
from service.store.course import assignment_settings, comments, overrides, regrade_requests
from service.store.database import is_loss, is_outage
from service.store.submissions import records
from service.store.submissions.accepting import Accepted, KeyReused, SubmissionRejected, TooManyOpen, accept
from service.store.submissions.records import NewSubmission, SubmissionRecord

catalogue = APIRouter(tags=["Assignments"])
router = APIRouter(tags=["Submissions"])
LONGEST_WAIT_S = 60.0
OPEN_RETRY_S = 10
SHARED = 10  # times as many open submissions for the person that all users of a server without logins share
Prefer = Annotated[str | None, Header(description="`wait=SECONDS` (at most 60), `no-repeat`, or both.")]
Key = Annotated[
    str | None,
    Header(max_length=200, description="A request with a known key returns the submission of the first."),
]


async def find_assignment(slug: str) -> Assignment:
    """Return the assignment. Raises Problem 404 if it does not exist, and InvalidAssignment, which is
    answered with 503, if its declaration is invalid.
    """
    try:
        return find(slug)
    except NoAssignment:
        raise Problem(404, "not-found", _no_assignment(slug)) from None


def _no_assignment(slug: str) -> str:
    return f"no assignment {slug[:80]}: check the address"


async def _submission(id: str, person: Reader, database: Db) -> SubmissionRecord:
    """Return the submission.

    Raises Problem 404 if it does not exist, and 403 if another student sent it.
    """
    stored = await records.read(database, identifier(id))
    if stored is None:
        raise Problem(404, "not-found", f"no submission {id[:80]}: check the address")
    if stored.person != person.name and person.role not in STAFF:
        raise Problem(403, "not-allowed", "you don't have permission: another student sent this submission")
    return visible(person, stored)


Assigned = Annotated[Assignment, Depends(find_assignment)]


async def _find_available(assignment: Assigned, person: OptionalUser, database: Db) -> Assignment:
    """Return the assignment. For anybody but the course staff, raises Problem 404 if it is a draft, and 403
    before it is available.
    """
    if person is not None and person.role in STAFF:
        return assignment
    closed = await assignment_settings.unavailable(database)
    if assignment.slug not in closed:
        return assignment
    opens = closed[assignment.slug]
    if opens is None:
        raise Problem(404, "not-found", _no_assignment(assignment.slug))
    at = f"{opens.astimezone(ZONE.get()):%Y-%m-%d %H:%M} {ZONE.get()}"
    raise Problem(403, "not-available", f"{assignment.title} is available from {at}: come back then")


Available = Annotated[Assignment, Depends(_find_available)]
"""An assignment as students see it: only once it is available."""
Submission = Annotated[SubmissionRecord, Depends(_submission)]


@catalogue.get("/v1/assignments", responses=problems({}))
async def list_assignments(visitor: Visitor, database: Db) -> list[response_models.Named]:
    """Return slug, title and version of every assignment, and ``available_from`` if that is still to come.

    Only the course staff gets drafts.
    """
    staff = isinstance(visitor, Person) and visitor.role in STAFF
    closed = await assignment_settings.unavailable(database)
    return [
        response_models.Named(
            slug=a.slug, title=a.title, version=a.version, available_from=closed.get(a.slug)
        )
        for a in assignments().values()
        if staff or closed.get(a.slug, True) is not None
    ]


@catalogue.get(
    "/v1/assignments/{slug}",
    responses=problems({403: "not-available", 404: "not-found", 503: "assignment-broken"}),
)
async def show_assignment(assignment: Available) -> response_models.Described:
    """Return the exercises with their functions and checks; each check has its tolerance, the reason
    for it, and ``hidden``.
    """
    slug = assignment.slug
    sections = [
        response_models.Exercise(
            number=e.number,
            title=e.title,
            functions=list(e.functions),
            optional=list(e.optional),
            variables=list(e.variables),
            checks=[
                response_models.Check(
                    id=c.id,
                    label=c.label,
                    hidden=assignment.hidden(c),
                    self_reported=is_self_reported(c),
                    tolerance={
                        key: value for key, value in document(c.tolerance).items() if value is not None
                    },
                )
                for c in e.checks
            ],
        )
        for e in assignment.exercises
    ]
    return response_models.Described(
        slug=slug,
        title=assignment.title,
        version=assignment.version,
        exercises=sections,
        kit=f"/kit/{kit.WHEEL}",
        kit_build=await asyncio.to_thread(kit.build),
        notebook=f"/v1/assignments/{slug}/notebook.ipynb",
        packages=packages.versions(assignment.packages),
    )


SUBMIT_BODY = {
    "required": True,
    "content": {
        "application/json": {
            "schema": {
                "type": "object",
                "required": ["source"],
                "additionalProperties": False,
                "properties": {
                    "source": {
                        "type": "string",
                        "description": "Python source, or the JSON text of a notebook.",
                    },
                    "filename": {
                        "type": "string",
                        "default": "submission.py",
                        "pattern": r"\.([pP][yY]|[iI][pP][yY][nN][bB])$",
                    },
                    "exercises": {"type": "array", "minItems": 1, "items": {"type": "string"}},
                },
            }
        },
        "multipart/form-data": {
            "schema": {
                "type": "object",
                "required": ["file"],
                "properties": {
                    "file": {"type": "string", "format": "binary", "description": "A .py or .ipynb file."},
                    "exercises": {"type": "array", "items": {"type": "string"}},
                },
            }
        },
    },
}
SUBMIT_PROBLEMS: dict[int, Kinds] = {
    401: "nobody",
    403: ("deadline-over", "none-left", "not-allowed", "not-available"),
    404: "not-found",
    408: "timed-out",
    413: "too-large",
    415: "unsupported-media-type",
    422: ("bad-submission", "invalid-request", "key-reused", "unknown-exercise"),
    429: "too-many-open",
    503: ("assignment-broken", "busy", "no-walls"),
}


async def _may_repeat(request: Request, prefer: Prefer = None) -> bool:
    """Return whether a submission that repeats the person's last one is stored too.

    A program says no with ``Prefer: no-repeat``. A page's form says yes with ``again`` in its address.
    """
    if not request.url.path.startswith("/v1/"):
        return "again" in request.query_params
    return re.search(r"(^|[,;\s])no-repeat([,;\s]|$)", prefer or "", re.IGNORECASE) is None


async def store_submission(
    request: Request,
    assignment: Available,
    person: Submitter,
    database: Db,
    settings: Config,
    workers: Held[WorkerStatus],
    large: Held[parse_submission.LargeBodies],
    repeat: Annotated[bool, Depends(_may_repeat)],
    idempotency_key: Key = None,
) -> Accepted:
    """Store the submission in the body and queue its grading; unless ``repeat``, only if it differs from the
    last one.

    Raises Problem if the sandbox is unavailable, or if the submission is invalid or not permitted.
    """
    arrived = time.monotonic()
    isolation, reason = await workers.current()
    if reason and not isolation:
        raise Problem(
            503,
            "no-walls",
            "the sandbox is unavailable, so submissions are not accepted: contact the course staff"
            f" ({reason})",
        )
    submission = await parse_submission.parse_submission(request, assignment, person.name, large)
    seed = secrets.randbits(48)
    new = NewSubmission(uuid.uuid4(), assignment.slug, person.name, submission, seed, arrived)
    most = None  # staff may submit for a class
    if person.single_user:
        most = SHARED * settings.open_submissions
    elif person.role not in STAFF:
        most = settings.open_submissions
    try:
        return await accept(database, new, idempotency_key or None, most_open=most, repeat=repeat)
    except TooManyOpen:
        detail = (
            f"{most} of your submissions are waiting for their reports, the most that may: submit again when"
            " one has its report"
        )
        raise Problem(429, "too-many-open", detail, retry_after=OPEN_RETRY_S) from None
    except KeyReused:
        raise Problem(
            422, "key-reused", "this Idempotency-Key was used with a different body: use a new key"
        ) from None
    except SubmissionRejected as reason:
        detail = str(reason)
        if reason.until:  # in the time zone of the page
            at = f"{reason.until.astimezone(ZONE.get()):%Y-%m-%d %H:%M} {ZONE.get()}"
            detail = f"the deadline was {at}: ask the course staff for an extension"
        raise Problem(403, reason.kind, detail) from reason


Stored = Annotated[Accepted, Depends(store_submission)]


@router.post(
    "/v1/assignments/{slug}/submissions",
    status_code=202,
    response_model=response_models.Submission,
    response_description="Stored",
    responses=also(
        200,
        "Graded within the time to wait, or the last submission, which this one repeats",
        response_models.Submission,
    )
    | problems(SUBMIT_PROBLEMS),
    openapi_extra={"requestBody": SUBMIT_BODY},
)
async def submit(
    person: Submitter,
    accepted: Stored,
    database: Db,
    listener: Held[Listener],
    prefer: Prefer = None,
) -> JSONResponse:
    """Store a submission and queue its grading: return 202, or 200 if it is graded within ``Prefer:
    wait=SECONDS``.

    With ``Prefer: no-repeat``, return the person's last submission with 200 if this one repeats it.
    """
    wait_s, location = _seconds(prefer), f"/v1/submissions/{accepted.id}"
    given = {name: getattr(accepted, name) for name in ("id", "submitted_at", "late", "sha256")}
    queued = response_models.Submission(**given, status="queued", report=None)
    if accepted.fresh and wait_s == 0:  # grading has only just been queued
        return _response(queued, 202, {"Location": location, "Retry-After": "1"})
    try:
        found = visible(person, await _wait(database, listener, accepted, wait_s))
    except Exception as error:
        if not is_outage(error) or is_loss(error):
            raise
        # the submission is stored despite the outage
        return _response(queued, 202, {"Location": location, "Retry-After": "5"})
    if accepted.repeated:
        return _response(
            _document(found, repeated=True), 200, {"Location": location, "Preference-Applied": "no-repeat"}
        )
    if found.finished and wait_s > 0:
        return _response(_document(found), 200, {"Location": location})
    return _response(_document(found), 202, {"Location": location, "Retry-After": "1"})


def _response(submission: response_models.Submission, status: int, headers: dict[str, str]) -> JSONResponse:
    return JSONResponse(submission.model_dump(mode="json", exclude_unset=True), status, headers)


@router.get(
    "/v1/submissions/{id}", response_model_exclude_unset=True, responses=problems(PERSON | {404: "not-found"})
)
async def show_submission(stored: Submission, database: Db) -> response_models.Submission:
    """Return the status of a submission, its report if graded, and the staff's overrides, answers and
    comments.
    """
    given = [] if stored.withheld else await overrides.of_submission(database, stored.id)
    in_force = [one for one in given if one.in_force]
    listed = [
        response_models.Override(check=o.check, points=o.points, reason=o.reason, by=o.by, at=o.at)
        for o in in_force
    ]
    feedback = {
        "regrade_requests": [
            asdict(one) for one in await regrade_requests.of_submission(database, stored.id)
        ],
        "comments": [asdict(one) for one in await comments.of_submission(database, stored.id)],
    }
    more: dict[str, Any] = {"points": stored.points, "overrides": listed} if listed else {}
    return _document(stored, **more, **{name: rows for name, rows in feedback.items() if rows})


def _document(stored: SubmissionRecord, **more: Any) -> response_models.Submission:
    more |= {"system_fault": stored.fault} if stored.fault else {}
    more |= {"cancelled_by": stored.cancelled_by} if stored.cancelled_by else {}
    more |= {name: getattr(stored, name) for name in ("id", "status", "submitted_at", "late")}
    more |= {"scores_released": False} if stored.withheld else {}
    if stored.points is not None and stored.penalty:
        more |= {"penalty": stored.penalty, "final": stored.final}
    report = document(stored.report) if stored.report else None
    return response_models.Submission(**more, sha256=stored.submission.sha256, report=report)


async def _wait(database: Db, listener: Listener, accepted: Accepted, seconds: float) -> SubmissionRecord:
    """Return the submission when it has its result, at latest after ``seconds``."""
    changes = listener.wait_for_changes(str(accepted.id), seconds, progress=False)
    if accepted.fresh:
        await anext(changes)  # starts to wait: a new submission has no result yet
    async for _ in changes:
        row = await listener.state(accepted.id)
        if row is None or row.finished:
            break
    stored = await records.read(database, accepted.id)
    assert stored is not None
    return stored


def _seconds(prefer: str | None) -> float:
    match = re.search(r'\bwait\s*=\s*"?(\d{1,300})\b', prefer or "", re.IGNORECASE)
    return min(float(match[1]), LONGEST_WAIT_S) if match else 0.0


@router.get(
    "/v1/submissions/{id}/report.txt",
    response_class=PlainTextResponse,
    responses=problems(PERSON | {404: "not-found", 409: "not-ready"}),
)
async def report_text(stored: Submission) -> PlainTextResponse:
    """Return the report as text, as the notebook prints it."""
    return PlainTextResponse(report_of(stored).text())


@router.get(
    "/v1/submissions/{id}/report.junit.xml",
    response_class=Response,
    responses=media("application/xml")
    | problems(PERSON | {404: "not-found", 409: "not-ready", 503: ("assignment-broken", "busy")}),
)
async def report_junit(stored: Submission) -> Response:
    """Return the report as JUnit XML for CI systems."""
    report = report_of(stored)
    seconds = sum(report.provenance.phases_ms.values()) / 1e3
    file = GradedFile(
        file=Path(stored.submission.filename), source=stored.submission.source, report=report, seconds=seconds
    )
    assignment = await find_assignment(stored.assignment)
    return Response(await asyncio.to_thread(junit.text, [file], assignment), media_type="application/xml")


def report_of(stored: SubmissionRecord) -> Report:
    """Return the submission's report. Raises Problem 409 if it has none, or its scores are not released."""
    if stored.withheld:
        raise Problem(409, "not-ready", NOT_RELEASED)
    if stored.report is None:
        raise Problem(
            409, "not-ready", stored.fault or "the submission has not been graded yet: try again later"
        )
    return stored.report
