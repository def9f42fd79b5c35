"""Parse a submission from an HTTP request, either JSON or an uploaded file, with a size cap."""

import json
from dataclasses import dataclass

from fastapi import Request
from starlette.datastructures import UploadFile

from exercises.assignment import Assignment
from service.grading.grade import UnknownExercise, select
from service.grading.submission import MOST_BYTES, BadSubmission, Submission
from service.http.errors import Problem
from service.http.requests import read_capped

MOST_BODY = 2 * MOST_BYTES + 64 * 1024  # JSON escapes may double the size of a source


@dataclass(frozen=True)
class ParsedSubmission:
    """A valid submission and the requested exercises (None: those it attempts)."""

    submission: Submission
    exercises: list[str] | None


async def parse_submission(request: Request, assignment: Assignment) -> ParsedSubmission:
    """Return the submission in ``request``. Raises Problem with a 4xx status if it is invalid."""
    kind = request.headers.get("content-type", "").split(";")[0].strip().lower()
    await read_capped(request, MOST_BODY, f"the submission is larger than {MOST_BYTES} bytes: send less")
    if kind == "application/json":
        parsed = await _from_json(request)
    elif kind == "multipart/form-data":
        parsed = await _from_form(request)
    else:
        raise Problem(415, "unsupported-media-type", f"send application/json or multipart/form-data, not {kind or 'nothing'}")
    try:
        select(assignment, parsed.exercises)
    except UnknownExercise as error:
        raise Problem(422, "unknown-exercise", str(error), "/exercises") from error
    return parsed


async def _from_json(request: Request) -> ParsedSubmission:
    try:
        document = json.loads(await request.body())
    except (ValueError, RecursionError):
        raise Problem(400, "invalid-request", "the body is not valid JSON") from None
    if not isinstance(document, dict) or not isinstance(document.get("source"), str):
        raise Problem(422, "invalid-request", 'the body must be a JSON object with a string "source"', "/source")
    if unknown := sorted(set(document) - {"source", "exercises", "filename"}):
        raise Problem(422, "invalid-request", f"unknown field {unknown[0]}: remove it", f"/{unknown[0]}")
    name = _filename(document.get("filename", "submission.py"), "/filename")
    return ParsedSubmission(_submission(document["source"].encode("utf-8", "replace"), name), _exercises(document))


async def _from_form(request: Request) -> ParsedSubmission:
    try:
        form = await request.form(max_files=1, max_fields=20)
    except Exception as error:
        raise Problem(400, "invalid-request", f"the form cannot be parsed: {error}") from error
    try:
        upload = form.get("file")
        if not isinstance(upload, UploadFile):
            raise Problem(422, "invalid-request", 'the form must have a file in its field "file"', "/file")
        name = _filename(upload.filename or "submission.py", "/file")
        numbers = [n for n in form.getlist("exercises") if isinstance(n, str)]
        return ParsedSubmission(_submission(await upload.read(), name), _exercises({"exercises": numbers or None}))
    finally:
        await form.close()


def _filename(value: object, pointer: str) -> str:
    name = "".join(c for c in value if c.isprintable()) if isinstance(value, str) else ""
    if not name.endswith((".py", ".ipynb")):
        raise Problem(422, "bad-submission", f"cannot grade the file {name[:80]!r}: submit a .py or .ipynb file", pointer)
    return name


def _submission(data: bytes, name: str) -> Submission:
    try:
        return Submission.from_bytes(data, name)
    except BadSubmission as error:
        status, kind = (413, "too-large") if len(data) > MOST_BYTES else (422, "bad-submission")
        raise Problem(status, kind, str(error), "/source") from error


def _exercises(document: dict[str, object]) -> list[str] | None:
    numbers = document.get("exercises")
    if numbers is None:
        return None
    if not isinstance(numbers, list) or not numbers or not all(isinstance(n, str) for n in numbers):
        raise Problem(422, "invalid-request", '"exercises" must be a non-empty list of exercise numbers as strings', "/exercises")
    return sorted(set(numbers))
