"""Parse a submission from an HTTP request, either JSON or an uploaded file, with a size cap."""

import asyncio
import contextlib
import functools
from collections.abc import AsyncIterator
from tempfile import SpooledTemporaryFile
from typing import IO
from weakref import WeakValueDictionary

from fastapi import Request

from exercises.authoring.assignments.assignment import Assignment
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
MOST_LARGE = 8  # larger bodies in memory at a time, each when all of it has arrived
MOST_ARRIVING = 2  # larger bodies of one person at a time
PARSE_S, WAIT_S = 30.0, 60.0
DISCARDED = 10  # times the limit: a client that is still sending would not see the response


class LargeBodies:
    """Large bodies of submissions: they arrive in files, a limited number is in memory, and a separate
    process parses them.
    """

    def __init__(self, settings: Settings) -> None:
        self.limits = SizeLimits(settings.upload_mib * MIB, settings.submission_kib * KIB)
        self.places = asyncio.Semaphore(MOST_LARGE)
        self._arriving = WeakValueDictionary[str, asyncio.Semaphore]()
        self.process = SeparateProcess(PARSE_S, functools.partial(submission_body.start_process, self.limits))

    def arriving_of(self, person: str) -> asyncio.Semaphore:
        """Return the places for large bodies of a person, so that nobody's slow ones keep others waiting."""
        return self._arriving.setdefault(person, asyncio.Semaphore(MOST_ARRIVING))


async def parse_submission(
    request: Request, assignment: Assignment, person: str, large: LargeBodies
) -> Submission:
    """Return the submission of a person in ``request``. Raises Problem with a 4xx status if it is invalid,
    503 while too many are large.
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
        submission = await _parse(request, kind, person, large)
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


async def _parse(request: Request, kind: str, person: str, large: LargeBodies) -> Submission:
    content_type, limits = request.headers["content-type"], large.limits
    with SpooledTemporaryFile(SMALL) as arriving:
        async with contextlib.AsyncExitStack() as stack:
            size = await _receive(request, arriving, limits, large.arriving_of(person), stack)
            if size <= SMALL:
                body = arriving.read()
                return (
                    await submission_body.parse_form(content_type, body, limits)
                    if kind == submission_body.FORM
                    else Submission.from_json(body, limits)
                )
            await stack.enter_async_context(_one_of(large.places))
            try:
                return await large.process.call(submission_body.parse, content_type, arriving.read(), limits)
            except ProcessLost as error:
                raise Problem(
                    503, "busy", "reading the submission took too long: try again in a minute", retry_after=60
                ) from error


async def _receive(
    request: Request,
    arriving: IO[bytes],
    limits: SizeLimits,
    places: asyncio.Semaphore,
    stack: contextlib.AsyncExitStack,
) -> int:
    """Write the body to the file ``arriving``, in one of the ``places`` if it is large, and return its size.
    Raises TooLarge, and Problem 503.
    """
    size = 0
    async for chunk in request.stream():
        if size <= SMALL < size + len(chunk):
            await stack.enter_async_context(_one_of(places))
        size += len(chunk)
        if size <= limits.upload:
            _write(chunk, arriving)
        elif size > DISCARDED * limits.upload:
            break
    if size > limits.upload:
        raise TooLarge(upload_too_large(limits))
    arriving.seek(0)
    return size


def _write(chunk: bytes, arriving: IO[bytes]) -> None:
    try:
        arriving.write(chunk)
    except OSError as error:  # its disk is full
        raise Problem(
            503, "busy", "the server has no room for a large submission: try again later", retry_after=60
        ) from error


@contextlib.asynccontextmanager
async def _one_of(places: asyncio.Semaphore) -> AsyncIterator[None]:
    """Wait for one of the places, and hold it in the ``with`` block. Raises Problem 503."""
    try:
        await asyncio.wait_for(places.acquire(), WAIT_S)
    except TimeoutError:
        raise Problem(
            503,
            "busy",
            "too many large submissions arrive at this moment: try again in a minute",
            retry_after=10,
        ) from None
    try:
        yield
    finally:
        places.release()
