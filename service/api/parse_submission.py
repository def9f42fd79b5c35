"""Parse a submission from an HTTP request, either JSON or an uploaded file, with a size cap."""

import asyncio
import contextlib
import functools

from fastapi import Request

from exercises.assignment import Assignment
from service.api import submission_body
from service.api.separate_process import ProcessLost, SeparateProcess
from service.grading.grade import UnknownExercise, select
from service.grading.submission import (
    KIB,
    MIB,
    BadDocument,
    BadSubmission,
    SizeLimits,
    Submission,
    TooLarge,
    upload_too_large,
)
from service.http.errors import Problem
from service.settings import Settings

SMALL = 256 * KIB  # parsed at once: the server cannot respond to others meanwhile
MOST_LARGE = 8  # larger bodies in memory at a time
PARSE_S, WAIT_S = 30.0, 60.0
DISCARDED = 10  # times the limit: a client that is still sending would not see the response


class LargeBodies:
    """Large bodies of submissions: a limited number is in memory, and a separate process parses them."""

    def __init__(self, settings: Settings) -> None:
        self.limits = SizeLimits(settings.upload_mib * MIB, settings.submission_kib * KIB)
        self.places = asyncio.Semaphore(MOST_LARGE)
        self.process = SeparateProcess(PARSE_S, functools.partial(submission_body.start_process, self.limits))


async def parse_submission(request: Request, assignment: Assignment, large: LargeBodies) -> Submission:
    """Return the submission in ``request``. Raises Problem with a 4xx status if it is invalid, 503 while too
    many are large.
    """
    content_type = request.headers.get("content-type", "")
    kind = content_type.split(";")[0].strip().lower()
    if kind not in (submission_body.FORM, submission_body.JSON):
        raise Problem(
            415,
            "unsupported-media-type",
            f"send application/json or multipart/form-data, not {kind or 'nothing'}",
        )
    try:
        submission = await _parse(request, kind, large)
    except TooLarge as error:
        raise Problem(413, "too-large", str(error), error.pointer) from error
    except BadDocument as error:
        raise Problem(
            422 if error.pointer else 400, "invalid-request", str(error), error.pointer or None
        ) from error
    except BadSubmission as error:
        raise Problem(422, "bad-submission", str(error), error.pointer) from error
    try:
        select(assignment, submission.exercises)
    except UnknownExercise as error:
        raise Problem(422, "unknown-exercise", str(error), "/exercises") from error
    return submission


async def _parse(request: Request, kind: str, large: LargeBodies) -> Submission:
    content_type, limits = request.headers["content-type"], large.limits
    async with contextlib.AsyncExitStack() as stack:
        chunks, size = [], 0
        async for chunk in request.stream():
            if size <= SMALL < size + len(chunk):
                await _take_place(large, stack)
            size += len(chunk)
            if size <= limits.upload:
                chunks.append(chunk)
                continue
            chunks.clear()
            await stack.aclose()
            if size > DISCARDED * limits.upload:
                break
        if size > limits.upload:
            raise TooLarge(upload_too_large(limits))
        body = b"".join(chunks)
        if size <= SMALL:
            return (
                await submission_body.parse_form(content_type, body, limits)
                if kind == submission_body.FORM
                else Submission.from_json(body, limits)
            )
        chunks.clear()
        try:
            return await large.process.call(submission_body.parse, content_type, body, limits)
        except ProcessLost as error:
            raise Problem(
                503, "busy", "reading the submission took too long: try again in a minute", retry_after=60
            ) from error


async def _take_place(large: LargeBodies, stack: contextlib.AsyncExitStack) -> None:
    """Wait for a place among the large bodies, which ``stack`` releases. Raises Problem 503."""
    try:
        await asyncio.wait_for(large.places.acquire(), WAIT_S)
    except TimeoutError:
        raise Problem(
            503,
            "busy",
            "too many large submissions arrive at this moment: try again in a minute",
            retry_after=10,
        ) from None
    stack.callback(large.places.release)
