"""What stopped a student's code, in the words of a report: the same behind the wall and in a notebook."""

import traceback
from collections.abc import Callable

from ecp.strict import WrongAnswer


def stopped(error: BaseException, own: Callable[[str], bool]) -> dict[str, str | None]:
    """The fields ``ending``, ``code``, ``sentence`` and ``traceback`` of a scene's ending; ``own(filename)``: theirs."""
    match error:
        case WrongAnswer():
            return {"ending": "wrong-answer", "code": error.code, "sentence": str(error)}
        case MemoryError():
            sentence = "your code asked for more memory than is allowed"
            return {"ending": "memory", "code": "memory", "sentence": sentence, "traceback": _trace(error, own)}
        case SyntaxError():
            return {"ending": "syntax-error", "code": "syntax-error", "sentence": _said(error), "traceback": _trace(error, own)}
    return {"ending": "raised", "code": "raises", "sentence": _said(error), "traceback": _trace(error, own)}


def _said(error: BaseException) -> str:
    try:
        return f"{type(error).__name__}: {error}"[:500]
    except BaseException:  # its own __str__ fails
        return type(error).__name__[:500]


def _trace(error: BaseException, own: Callable[[str], bool]) -> str | None:
    """The student's own lines of the traceback: frames of the harness and of the libraries are left out."""
    try:
        frames = [f for f in traceback.extract_tb(error.__traceback__) if own(f.filename)]
        return "".join(traceback.format_list(frames[-8:]) + traceback.format_exception_only(error))[:6000]
    except BaseException:
        return None
