"""How a scene or a cell ended, as the fields of an event, with a sentence that says what to do."""

import errno
import linecache
import platform
import re
import traceback
from typing import Any

from ecp.author_errors import SOURCES, author_error
from ecp.return_value import describe_exception

from .budget import Budget, OutOfTime
from .scratch import NO_ROOM
from .statements import Cause

PYTHON = ".".join(platform.python_version_tuple()[:2])
NEWER_SYNTAX = re.compile(r"^\s*(type \w|(async )?def \w+\[|class \w+\[|except [\w., ]+,)|\bt['\"]")
"""Lines that a newer Python understands: PEP 695, 750 and 758. Errors in f-strings may be PEP 701."""
NO_PROCESSES = "the grader starts no processes: compute this without subprocess and multiprocessing"
NO_THREADS = "the grader starts no threads: compute this without them"
NO_NETWORK = "the grader has no network: put the data into the notebook or read a file of the assignment"
NO_INPUT = "the grader cannot ask for input: write the value into the code"
ELSEWHERE = "the grader opens files only in the working folder: use a relative name"
MODULES = (
    (re.compile(r"/(subprocess|multiprocessing/\w+|concurrent/futures/process|pty)\.py$"), NO_PROCESSES),
    (re.compile(r"/(threading|concurrent/futures/thread)\.py$"), NO_THREADS),
    (re.compile(r"/(socket|ssl|http/client|urllib/request|ftplib|smtplib)\.py$"), NO_NETWORK),
)
PROCESS_CALL = re.compile(r"\bos\.(fork\w*|posix_spawn\w*|exec\w+|system|popen|spawn\w+|kill)\(")
FULL = (errno.ENOSPC, errno.EFBIG, errno.EDQUOT)
CLOSED = (errno.EACCES, errno.EROFS)


def ending(error: BaseException | None, budget: Budget, cause: Cause | None = None) -> dict[str, Any]:
    """Return the fields of an event for what an action raised. ``cause`` says why a name in it is missing."""
    if error is None:
        return {"ended": "finished", "sentence": "finished"}
    if isinstance(error, OutOfTime):
        return {"ended": "timed-out", "code": "timeout", "sentence": budget.sentence()}
    ended = describe_exception(error, is_of_submission) | {"author": _author_error(error)}
    if cause is not None:
        ended["sentence"] = f"`{getattr(error, 'name', '')}` is missing because {cause.sentence}"[:500]
    elif said := _limit(error):
        ended["sentence"] = f"{said} ({ended['sentence']})"[:500]
    return ended


def is_of_submission(filename: str) -> bool:
    """Return whether a file name in a traceback is that of a cell of the submission."""
    return filename in linecache.cache and "/" not in filename and filename not in SOURCES


def _limit(error: BaseException) -> str:
    """Return which limit of the sandbox an exception comes from, or ""."""
    if isinstance(error, SyntaxError):
        newer = "f-string" in (error.msg or "") or NEWER_SYNTAX.search(error.text or "")
        return f"the grader runs Python {PYTHON}, which may lack newer syntax" if newer else ""
    try:
        frames = traceback.extract_tb(error.__traceback__)
    except BaseException:  # a submission can replace what that uses
        return ""
    last = (frames[-1].line or "") if frames else ""
    if isinstance(error, EOFError) and "input(" in last:
        return NO_INPUT
    if isinstance(error, OSError) and (error.errno in FULL or PROCESS_CALL.search(last)):
        return NO_ROOM if error.errno in FULL else NO_PROCESSES
    named = [said for frame in frames for pattern, said in MODULES if pattern.search(frame.filename)]
    if not isinstance(error, OSError | RuntimeError | ImportError):
        named.clear()
    opened = isinstance(error, OSError) and error.errno in CLOSED and error.filename is not None
    imported = bool(frames) and frames[-1].filename.startswith("<frozen importlib")
    return named[-1] if named else ELSEWHERE if opened and not imported else ""


def _author_error(error: BaseException) -> str | None:
    try:
        return author_error(
            error,
            lambda name: is_of_submission(name) or (name[:1] == "<" and not name.startswith("<frozen")),
        )
    except BaseException:  # its own __str__ fails, for example
        return None
