"""How a scene or a cell ended, as the fields of an event, with a sentence that says what to do."""

import linecache
from contextlib import suppress
from typing import Any, NamedTuple

from polhode.judging.author_errors import SOURCES, author_error
from polhode.judging.return_value import describe_exception

from .confinement.limits import limit
from .time_budget import Budget, OutOfTime

MOST_SENTENCE, MOST_CAUSE = 500, 400


class Cause(NamedTuple):
    """Why a name is missing: the sentence, the diagnosis code and the traceback of the failure."""

    sentence: str
    code: str | None
    traceback: str | None


def ending(error: BaseException | None, budget: Budget, cause: Cause | None = None) -> dict[str, Any]:
    """Return the fields of an event for what an action raised. ``cause`` says why a name in it is missing."""
    if error is None:
        return {"ended": "finished", "sentence": "finished"}
    if isinstance(error, OutOfTime):
        return {"ended": "timed-out", "code": "timeout", "sentence": budget.sentence()}
    ended = describe(error) | {"author": _author_error(error)}
    if cause is None:
        return ended
    sentence = f"`{getattr(error, 'name', '')}` is missing because {cause.sentence}"[:MOST_SENTENCE]
    return ended | {"sentence": sentence, "because": cause.sentence, "code": cause.code}


def describe(error: BaseException) -> dict[str, Any]:
    """Return the fields of an event for an exception. If it comes from a limit of the sandbox, the sentence
    says so.
    """
    said = ""
    with suppress(BaseException):  # a submission can replace what this uses
        if isinstance(error, SyntaxError) and error.text is None:  # one of a statement that is parsed
            error.text = linecache.getline(error.filename or "", error.lineno or 0)
        said = limit(error)
    ended = describe_exception(error, is_of_submission)
    return ended | {"sentence": f"{said} ({ended['sentence']})"[:MOST_SENTENCE]} if said else ended


def is_of_submission(filename: str) -> bool:
    """Return whether a file name in a traceback is that of a cell of the submission."""
    return filename in linecache.cache and "/" not in filename and filename not in SOURCES


def _author_error(error: BaseException) -> str | None:
    try:
        return author_error(
            error,
            lambda name: is_of_submission(name) or (name[:1] == "<" and not name.startswith("<frozen")),
        )
    except BaseException:  # its own __str__ fails, for example
        return None
