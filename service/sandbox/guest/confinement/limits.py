"""The limits of the sandbox that exceptions come from, as sentences that say what to do."""

import errno
import platform
import re
import sys
import traceback
from collections.abc import Callable, Iterator
from typing import Any

from .scratch import NO_ROOM

PYTHON = ".".join(platform.python_version_tuple()[:2])
OLDER_PYTHON = f"the grader runs Python {PYTHON}: if newer syntax is the reason, write this without it"
NO_PROCESSES = "the grader starts no processes: compute this in one, without multiprocessing or subprocess"
NO_THREADS = "the grader starts no threads: compute this without them"
NO_NETWORK = "the grader has no network: put the data into the notebook or read a file of the assignment"
NO_INPUT = "the grader cannot ask for input: write the value into the code"
NO_DEBUGGER = "the grader cannot ask for input: remove the breakpoint"
ELSEWHERE = "the grader opens files only in the working folder: use a relative name"
NO_LIBRARY = "the grader does not have `{name}`: do without it"
NO_CALL = "the grader does not allow this: do without it"
CLOSED = (errno.EACCES, errno.EROFS)
FULL = (errno.ENOSPC, errno.EFBIG, errno.EDQUOT)
NETWORK = re.compile(
    r"/(socket|ssl|socketserver|asyncio/streams|http/(client|server)|urllib/request|(ftp|imap|pop|smtp)lib)\.py$"
)
PROCESSES = re.compile(r"/(subprocess|multiprocessing/\w+|concurrent/futures/process|pty)\.py$")
THREADS = re.compile(r"/(threading|concurrent/futures/thread)\.py$")
FILES = (NETWORK, PROCESSES, THREADS)
"""Files whose code meets a limit. The outermost of a traceback decides."""
PROCESS_CALL = re.compile(r"\bos\.(fork\w*|posix_spawn\w*|exec\w+|popen|spawn\w+)\(")
URL = re.compile(r"\b(https?|ftp)://")
NO_TLS = re.compile(r"\b(HTTPSConnection|HTTPSHandler)\b")
NO_MORE_THREADS = ("can't start new thread", "Resource temporarily unavailable")
MOST_CAUSES = 5

F_STRING = r"\b[rR]?[fF][rR]?(?P<quote>[\"'])"
NESTED = r"\{(?:[^{}]*[^\w)\]{}\"'])?[fFrRbBuU]{0,2}"  # in it, what stands before another string
UNFINISHED = r"\{\s*(?:[^\"'{}]*[({\[,+*/=-]\s*)?$"  # in it, an expression that goes on in the next line
NEWER_SYNTAX = {
    (3, 12): re.compile(
        r"^\s*type\s+[^\W\d]\w*\s*(\[.*\])?\s*=(?!=)"
        r"|^\s*(async\s+)?def\s+\w+\s*\[[^\]]*\]\s*\("
        r"|^\s*class\s+\w+\s*\[[^\]]*\]\s*[(:]"
        rf"|{F_STRING}(?:(?!(?P=quote)).)*?{NESTED}(?P=quote).*(?P=quote).*\}}"
        rf"|{F_STRING.replace('quote', 'open')}[^\"']*{UNFINISHED}"
    ),
    (3, 14): re.compile(
        r"^\s*except\*?\s+[\w.]+(\s*,\s*(\w+\.)*[A-Z]\w*)+\s*:"
        r"|(?<![\w'\"])([tT][rR]?|[rR][tT])([\"'])[^\"']*\{"
    ),
}
"""Lines that Python understands from this version on: PEP 695, 701, 750 and 758."""
NEWER_MESSAGE = re.compile(r"f-string expression part cannot include (a backslash|'#')")


def limit(error: BaseException) -> str:
    """Return the limit of the sandbox from which an exception comes as a sentence, or ""."""
    if isinstance(error, SyntaxError):
        return OLDER_PYTHON if _may_be_newer(error) else ""
    met = next(filter(None, map(_met, _with_causes(error))), "")
    context = error.__context__
    return (context is not None and met and _met(context)) or met  # asyncio meets another one when it ends


def _may_be_newer(error: SyntaxError) -> bool:
    line, message = error.text or "", error.msg or ""
    newer = [pattern for version, pattern in NEWER_SYNTAX.items() if version > sys.version_info]
    return any(pattern.search(line) for pattern in newer) or bool(NEWER_MESSAGE.search(message))


def _with_causes(error: BaseException) -> Iterator[BaseException]:
    one: BaseException | None = error
    for _ in range(MOST_CAUSES):
        if one is not None:
            yield one
            one = one.__cause__


def _met(error: BaseException) -> str:
    """Return the limit that an exception itself shows."""
    frames = traceback.extract_tb(error.__traceback__)
    said = next((said for said, is_met in LIMITS if is_met(error, frames)), "")
    return said.format(name=(getattr(error, "name", None) or "this library").strip("_"))


Frames = traceback.StackSummary
IsMet = Callable[[Any, Frames], bool]


def _asks(error: BaseException, frames: Frames) -> bool:
    asks = str(error) == "EOF when reading a line" or any(f.filename.endswith("/getpass.py") for f in frames)
    return isinstance(error, EOFError) and asks


def _in_file(files: re.Pattern[str]) -> IsMet:
    """Return whether the exception comes through a file of the standard library, from which ``error`` only
    has the system's answer.
    """
    kinds = (OSError, RuntimeError, ImportError)
    return lambda error, frames: isinstance(error, kinds) and _outermost(frames) is files


def _outermost(frames: Frames) -> re.Pattern[str] | None:
    return next((files for frame in frames for files in FILES if files.search(frame.filename)), None)


def _lacks_tls(error: BaseException, frames: Frames) -> bool:
    return isinstance(error, AttributeError | ImportError) and bool(NO_TLS.search(str(error)))


def _lacks_library(error: BaseException, frames: Frames) -> bool:
    unlinked = isinstance(error, ImportError) and "cannot open shared object file" in str(error)
    name = getattr(error, "name", None) or ""
    of_python = isinstance(error, ModuleNotFoundError) and name.partition(".")[0] in sys.stdlib_module_names
    return unlinked or of_python  # a system may have Python without some of its own modules


def _starts_process(error: BaseException, frames: Frames) -> bool:
    calls = isinstance(error, BlockingIOError) or any(PROCESS_CALL.search(f.line or "") for f in frames)
    return isinstance(error, OSError) and calls


def _opens(error: BaseException, frames: Frames) -> bool:
    imports = bool(frames) and frames[-1].filename.startswith("<frozen importlib")
    closed = isinstance(error, OSError) and error.errno in CLOSED and error.filename is not None
    return closed and not imports


def _connects(error: BaseException, frames: Frames) -> bool:
    in_library = bool(frames) and "/" in frames[-1].filename
    named = type(error).__name__ in ("gaierror", "herror") or (in_library and URL.search(str(error)))
    return isinstance(error, OSError) and bool(named)


LIMITS: tuple[tuple[str, IsMet], ...] = (
    (NO_INPUT, _asks),
    (NO_DEBUGGER, lambda error, frames: type(error).__name__ == "BdbQuit"),
    (NO_ROOM, lambda error, frames: isinstance(error, OSError) and error.errno in FULL),
    (NO_NETWORK, _lacks_tls),
    (NO_NETWORK, _in_file(NETWORK)),
    (NO_PROCESSES, _in_file(PROCESSES)),
    (NO_THREADS, _in_file(THREADS)),
    (NO_LIBRARY, _lacks_library),
    (NO_THREADS, lambda error, frames: isinstance(error, RuntimeError) and str(error) in NO_MORE_THREADS),
    (NO_PROCESSES, _starts_process),
    (NO_NETWORK, _connects),
    (ELSEWHERE, _opens),
    (NO_CALL, lambda error, frames: isinstance(error, OSError) and error.errno == errno.EPERM),
)
