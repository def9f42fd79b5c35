"""The submission in the body of a request. Large bodies are parsed in a process of their own.

Python's JSON parser holds the interpreter lock until it has finished, so parsing 20 MiB in a thread would
stop all other requests.
"""

import asyncio
import os
import resource
from collections.abc import AsyncGenerator
from dataclasses import replace

from starlette.datastructures import Headers, UploadFile
from starlette.formparsers import MultiPartParser

from service.grading.submission import (
    DEFAULT_SIZES,
    PYTHON_FILE,
    BadDocument,
    SizeLimits,
    Submission,
    TooLarge,
    check_exercises,
    check_filename,
    upload_too_large,
)
from service.sandbox.guest.confinement.lockdown import die_with_parent

FORM, JSON = "multipart/form-data", "application/json"
MEMORY = 50  # times the largest upload; "[]," repeated takes 25 times its length
NICENESS = 5


def parse(content_type: str, body: bytes, limits: SizeLimits) -> Submission:
    """Return the submission in a body of the media type FORM or JSON.
    Raises BadSubmission if it is invalid.
    """
    try:
        if content_type.lower().startswith(FORM):
            return asyncio.run(parse_form(content_type, body, limits))
        return Submission.from_json(body, limits)
    except MemoryError:
        raise TooLarge(upload_too_large(limits)) from None


async def parse_form(content_type: str, body: bytes, limits: SizeLimits) -> Submission:
    """Return the submission in a form with a ``file`` and any number of ``exercises``.

    Raises BadSubmission if it is invalid.
    """

    async def stream() -> AsyncGenerator[bytes, None]:
        yield body

    try:
        parser = MultiPartParser(
            Headers({"content-type": content_type}), stream(), max_files=1, max_fields=20
        )
        parser.spool_max_size = limits.upload  # the file stays in memory
        form = await parser.parse()
    except Exception as error:
        raise BadDocument(f"the form cannot be parsed: {error}", "") from error
    try:
        upload = form.get("file")
        if not isinstance(upload, UploadFile):
            raise BadDocument('the form must have a file in its field "file"', "/file")
        name = check_filename(upload.filename or PYTHON_FILE, "/file")
        numbers = [n for n in form.getlist("exercises") if isinstance(n, str)]
        submission = Submission.from_bytes(await upload.read(), name, limits)
        return replace(submission, exercises=check_exercises(numbers or None))
    finally:
        await form.close()


def start_process(limits: SizeLimits, parent: int) -> None:
    """Prepare the process that parses: it ends with its parent, yields to it, and has limited memory."""
    die_with_parent(parent)
    os.nice(NICENESS)
    most = MEMORY * max(limits.upload, DEFAULT_SIZES.upload)
    resource.setrlimit(resource.RLIMIT_DATA, (most, most))
