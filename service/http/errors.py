"""Error responses: problem+json (RFC 9457) with a stable type, or an HTML page for a browser."""

import logging
import time
from collections.abc import Mapping
from functools import partial

import psycopg
from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse, Response
from procrastinate.exceptions import ConnectorException
from starlette.exceptions import HTTPException

from exercises.authoring.assignments.assignment import InvalidAssignment
from service.http.templating import templates
from service.store.database import DatabaseLost, is_loss, is_outage

log = logging.getLogger(__name__)
RETRY_AFTER_S = "5"
PROBLEM_TYPE = "application/problem+json"
LOG_EVERY_S = 60.0  # for each reason of an outage, rather than for each request

TITLES = {
    "assignment-broken": "Assignment unavailable",
    "bad-submission": "Submission cannot be graded",
    "changed-meanwhile": "Changed in the meantime",
    "database-lost": "Database unavailable",
    "busy": "Temporarily unavailable",
    "deadline-over": "Deadline has passed",
    "fault": "Internal error",
    "invalid-request": "Invalid request",
    "key-reused": "Idempotency key already used",
    "no-walls": "Sandbox unavailable",
    "nobody": "Authentication required",
    "login-over": "Login expired or refused",
    "none-left": "Submission limit reached",
    "not-allowed": "Permission denied",
    "not-available": "Not available yet",
    "not-found": "Not found",
    "not-ready": "Not ready yet",
    "timed-out": "Request timed out",
    "too-large": "Request too large",
    "too-many": "Too many logins",
    "too-many-open": "Too many submissions waiting",
    "unknown-exercise": "Unknown exercise",
    "unsupported-media-type": "Unsupported media type",
}
PAGE_TITLES = {**TITLES, "not-found": "Page not found"}
BY_STATUS = {
    404: "not-found",
    405: "invalid-request",
    413: "too-large",
    415: "unsupported-media-type",
    503: "busy",
}


class Problem(Exception):
    """An error to return to the client.

    ``kind`` is a key of TITLES. ``pointer`` is a JSON pointer (RFC 6901) to the offending part of the body.
    ``retry_after`` is the number of seconds after which the client may try again.
    """

    def __init__(
        self,
        status: int,
        kind: str,
        detail: str,
        pointer: str | None = None,
        *,
        retry_after: int | None = None,
    ) -> None:
        super().__init__(detail)
        self.status, self.kind, self.detail, self.pointer, self.retry_after = (
            status,
            kind,
            detail,
            pointer,
            retry_after,
        )

    def headers(self) -> dict[str, str]:
        """Return the additional response headers."""
        if self.retry_after is not None:
            return {"Retry-After": str(self.retry_after)}
        return {"Retry-After": RETRY_AFTER_S} if self.status == 503 else {}


def install(app: FastAPI) -> None:
    """Register handlers that turn every error of ``app`` into a problem response."""
    app.add_exception_handler(Problem, _problem)
    app.add_exception_handler(HTTPException, _http)
    app.add_exception_handler(RequestValidationError, _validation)
    app.add_exception_handler(InvalidAssignment, _broken_assignment)
    logged: dict[str, float] = {}
    for outage in (psycopg.Error, ConnectorException, DatabaseLost):
        app.add_exception_handler(outage, partial(_outage, logged))


def problem_response(
    status: int, kind: str, detail: str, errors: list[dict[str, str]] | None = None, **headers: str
) -> JSONResponse:
    """Return a problem+json response."""
    body = {
        "type": f"urn:polhode:problem:{kind}",
        "title": TITLES.get(kind, "Error"),
        "status": status,
        "detail": encodable(detail),
    }
    if errors:
        body["errors"] = [{key: encodable(value) for key, value in error.items()} for error in errors]
    return JSONResponse(body, status, headers, media_type=PROBLEM_TYPE)


def encodable(text: str) -> str:
    """Return the text with "?" for lone surrogates, which parts of a request may contain."""
    return text.encode("utf-8", "replace").decode()


async def _problem(request: Request, error: Exception) -> Response:
    assert isinstance(error, Problem)
    return _respond(
        request, error, [{"pointer": error.pointer, "detail": error.detail}] if error.pointer else None
    )


def wants_page(request: Request) -> bool:
    """Return whether a browser requests an HTML page."""
    return not request.url.path.startswith("/v1/") and "text/html" in request.headers.get("accept", "")


def _respond(
    request: Request,
    problem: Problem,
    errors: list[dict[str, str]] | None = None,
    more: Mapping[str, str] | None = None,
) -> Response:
    headers = {**problem.headers(), **(more or {})}
    if not wants_page(request):
        return problem_response(problem.status, problem.kind, problem.detail, errors, **headers)
    context = {"title": PAGE_TITLES.get(problem.kind, "Error"), "detail": encodable(problem.detail)}
    return templates.TemplateResponse(
        request, "problem.html", context, status_code=problem.status, headers=headers
    )


async def _http(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    kind, detail = (
        BY_STATUS.get(error.status_code, "invalid-request"),
        f"{error.detail}: {request.method} {request.url.path}",
    )
    return _respond(request, Problem(error.status_code, kind, detail), more=error.headers)


async def _validation(request: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)
    errors = [{"pointer": "/" + "/".join(map(str, e["loc"][1:])), "detail": e["msg"]} for e in error.errors()]
    return _respond(
        request, Problem(422, "invalid-request", errors[0]["detail"] if errors else "invalid"), errors
    )


async def _broken_assignment(request: Request, error: Exception) -> Response:
    assert isinstance(error, InvalidAssignment)
    detail = f"the assignment {error.slug} is broken (our error): contact the course staff"
    return _respond(request, Problem(503, "assignment-broken", detail, retry_after=60))


async def _outage(logged: dict[str, float], request: Request, error: Exception) -> Response:
    # Any database error that is not an outage is a bug: the middleware logs it and returns 500.
    if not is_outage(error):
        raise error
    loss = is_loss(error)
    reason = str(error).split("\n")[0] if loss else type(error).__name__
    now = time.monotonic()
    if now - logged.get(reason, float("-inf")) > LOG_EVERY_S:
        logged[reason] = now
        log.error("database unavailable: %s", reason)
    if loss:
        detail = (
            "this server has lost its database, and nothing can be stored until the course staff has restored"
            " it: keep your work"
        )
        return _respond(request, Problem(503, "database-lost", detail, retry_after=60))
    return _respond(request, Problem(503, "busy", "the database does not respond: try again in a moment"))


def internal_error() -> JSONResponse:
    """Return the response to an unexpected exception."""
    return problem_response(
        500,
        "fault",
        "polhode failed (our error): try again later; contact the course staff if the error persists",
    )
