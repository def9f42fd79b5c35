"""From an HTTP request to a submission: JSON or an uploaded file, size-capped while it arrives."""

import json
from dataclasses import dataclass

from fastapi import Request
from starlette.datastructures import UploadFile

from exercises.assignment import Assignment
from service.grading.grade import UnknownExercise, select
from service.grading.submission import MOST_BYTES, BadSubmission, Submission
from service.http.errors import Problem
from service.http.requests import read_capped

MOST_BODY = 2 * MOST_BYTES + 64 * 1024  # a source may double in size when JSON escapes it


@dataclass(frozen=True)
class ParsedSubmission:
    """A submission that can be graded, and the exercises asked for (None: those it attempts)."""

    submission: Submission
    exercises: list[str] | None


async def parse_submission(request: Request, assignment: Assignment) -> ParsedSubmission:
    """The submission in ``request``; Problem with a 4xx status for anything that is none."""
    kind = request.headers.get("content-type", "").split(";")[0].strip().lower()
    await read_capped(request, MOST_BODY, f"a submission has at most {MOST_BYTES} bytes")
    if kind == "application/json":
        received = await _from_json(request)
    elif kind == "multipart/form-data":
        received = await _from_form(request)
    else:
        raise Problem(415, "unsupported-media-type", f"send application/json or multipart/form-data, not {kind or 'nothing'}")
    try:
        select(assignment, received.exercises)
    except UnknownExercise as error:
        raise Problem(422, "unknown-exercise", str(error), "/exercises") from error
    return received


async def _from_json(request: Request) -> ParsedSubmission:
    try:
        document = json.loads(await request.body())
    except (ValueError, RecursionError):
        raise Problem(400, "invalid-request", "the body is not JSON") from None
    if not isinstance(document, dict) or not isinstance(document.get("source"), str):
        raise Problem(422, "invalid-request", 'the body is an object with a string "source"', "/source")
    if unknown := sorted(set(document) - {"source", "exercises", "filename"}):
        raise Problem(422, "invalid-request", f"unknown field {unknown[0]}", f"/{unknown[0]}")
    name = _filename(document.get("filename", "submission.py"), "/filename")
    return ParsedSubmission(_submission(document["source"].encode("utf-8", "replace"), name), _exercises(document))


async def _from_form(request: Request) -> ParsedSubmission:
    try:
        form = await request.form(max_files=1, max_fields=20)
    except Exception as error:
        raise Problem(400, "invalid-request", f"the form cannot be read: {error}") from error
    try:
        upload = form.get("file")
        if not isinstance(upload, UploadFile):
            raise Problem(422, "invalid-request", 'the form has no file in its field "file"', "/file")
        name = _filename(upload.filename or "submission.py", "/file")
        numbers = [n for n in form.getlist("exercises") if isinstance(n, str)]
        return ParsedSubmission(_submission(await upload.read(), name), _exercises({"exercises": numbers or None}))
    finally:
        await form.close()


def _filename(given: object, pointer: str) -> str:
    name = "".join(c for c in given if c.isprintable()) if isinstance(given, str) else ""
    if not name.endswith((".py", ".ipynb")):
        raise Problem(422, "bad-submission", f"{name[:80]} is neither a .py nor an .ipynb file", pointer)
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
        raise Problem(422, "invalid-request", '"exercises" is a list of exercise numbers as strings', "/exercises")
    return sorted(set(numbers))
