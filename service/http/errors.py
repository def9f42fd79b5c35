"""One shape for every error: problem+json (RFC 9457) with a stable type, and where in the request it lies."""

import logging
from collections.abc import Mapping

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse, Response
from sqlalchemy.exc import DBAPIError
from sqlalchemy.exc import TimeoutError as NoConnection
from starlette.exceptions import HTTPException

from service.http.templating import templates
from service.store.database import is_outage

log = logging.getLogger(__name__)
RETRY_AFTER_S = "5"

TITLES = {
    "assignment-broken": "The assignment cannot be used now",
    "bad-submission": "This cannot be graded",
    "changed-meanwhile": "Somebody else was first",
    "busy": "The server cannot answer this now",
    "deadline-over": "The deadline is over",
    "fault": "polhode failed",
    "invalid-request": "The request is not understood",
    "key-reused": "This idempotency key was used for another submission",
    "no-walls": "No worker has a working sandbox",
    "nobody": "The request does not tell whose it is",
    "login-over": "This login was not confirmed in time, or refused",
    "none-left": "No submission is left",
    "not-allowed": "This is not yours to do",
    "not-found": "There is nothing here",
    "not-ready": "The result is not there yet",
    "too-large": "The request is too large",
    "too-many": "Too many have failed",
    "unknown-exercise": "The assignment has no such exercise",
    "unsupported-media-type": "Send JSON or a multipart file",
}
BY_STATUS = {404: "not-found", 405: "invalid-request", 413: "too-large", 415: "unsupported-media-type", 503: "busy"}


class Problem(Exception):
    """An error answer. ``kind`` is a key of TITLES; ``pointer`` names the offending part of a JSON body (RFC 6901);
    ``retry_after`` tells in how many seconds it is worth another try."""

    def __init__(self, status: int, kind: str, detail: str, pointer: str | None = None, *, retry_after: int | None = None) -> None:
        super().__init__(detail)
        self.status, self.kind, self.detail, self.pointer, self.retry_after = status, kind, detail, pointer, retry_after

    def headers(self) -> dict[str, str]:
        """What the answer says besides."""
        if self.retry_after is not None:
            return {"Retry-After": str(self.retry_after)}
        return {"Retry-After": RETRY_AFTER_S} if self.status == 503 else {}


def install(app: FastAPI) -> None:
    """Answer every error of ``app`` as a problem."""
    app.add_exception_handler(Problem, _problem)
    app.add_exception_handler(HTTPException, _http)
    app.add_exception_handler(RequestValidationError, _validation)
    for outage in (DBAPIError, NoConnection):
        app.add_exception_handler(outage, _outage)


def problem_response(
    status: int, kind: str, detail: str, errors: list[dict[str, str]] | None = None, **headers: str
) -> JSONResponse:
    """The problem document as a response."""
    body = {"type": f"urn:polhode:problem:{kind}", "title": TITLES.get(kind, "Error"), "status": status, "detail": _plain(detail)}
    if errors:
        body["errors"] = [{key: _plain(value) for key, value in error.items()} for error in errors]
    return JSONResponse(body, status, headers, media_type="application/problem+json")


def _plain(words: str) -> str:
    """What of a request is repeated in an answer can be encoded."""
    return words.encode("utf-8", "replace").decode()


async def _problem(request: Request, error: Exception) -> Response:
    assert isinstance(error, Problem)
    return _tell(request, error, [{"pointer": error.pointer, "detail": error.detail}] if error.pointer else None)


def wants_page(request: Request) -> bool:
    """Whether a browser asks for a page, to show it to somebody."""
    return not request.url.path.startswith("/v1/") and "text/html" in request.headers.get("accept", "")


def _tell(
    request: Request, problem: Problem, errors: list[dict[str, str]] | None = None, more: Mapping[str, str] | None = None
) -> Response:
    """As a page to somebody who looks at pages, else as a document; ``more`` are headers."""
    headers = {**problem.headers(), **(more or {})}
    if not wants_page(request):
        return problem_response(problem.status, problem.kind, problem.detail, errors, **headers)
    context = {"title": TITLES.get(problem.kind, "Error"), "detail": _plain(problem.detail)}
    return templates.TemplateResponse(request, "problem.html", context, status_code=problem.status, headers=headers)


async def _http(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    kind, detail = BY_STATUS.get(error.status_code, "invalid-request"), f"{error.detail}: {request.method} {request.url.path}"
    return _tell(request, Problem(error.status_code, kind, detail), more=error.headers)


async def _validation(request: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)
    errors = [{"pointer": "/" + "/".join(map(str, e["loc"][1:])), "detail": e["msg"]} for e in error.errors()]
    return _tell(request, Problem(422, "invalid-request", errors[0]["detail"] if errors else "invalid"), errors)


async def _outage(request: Request, error: Exception) -> Response:
    """The database is away for a moment; whatever else the database objects to is a fault of ours."""
    if not is_outage(error):
        raise error
    log.warning("the database is out: %s", type(error).__name__)
    return _tell(request, Problem(503, "busy", "the database does not answer: try again in a moment"))


def internal_error() -> JSONResponse:
    """The answer to a failure of ours."""
    return problem_response(500, "fault", "polhode failed; the failure is ours and has been logged")
