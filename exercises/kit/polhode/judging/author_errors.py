"""Errors in an assignment's own code: recognized by the traceback, never reported as a student's mistake."""

import traceback
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polhode.client.errors import NotebookError
from polhode.judging.return_value import WrongAnswer

KIT = Path(__file__).parent
SOURCES = ("plays.py", "Setup", "question")  # names of code that is not read from a file
LIBRARIES = {"site-packages", "dist-packages"}
UNUSABLE = "the checks could not call {function} or use what it returned ({error})"


class AuthorError(NotebookError):
    """The assignment's own code failed. The message names file and line."""


def author_error(error: BaseException, own: Callable[[str], bool]) -> str | None:
    """Return file, line and message of an exception that the student's code did not raise itself, else None.

    ``own(filename)`` is true for the student's code. Outside of the libraries, and of the kit if it serves
    the student, the innermost frame is then one of the assignment; or all frames are of the kit. The cause
    may still be a value that the student returned.
    """
    if isinstance(error, AuthorError):
        return str(error)
    frames = traceback.extract_tb(error.__traceback__)
    ours = [f for f in frames if own(f.filename) or f.filename in SOURCES]
    ours = ours or [f for f in frames if KIT in Path(f.filename).parents]  # the student may call the kit
    if isinstance(error, WrongAnswer | MemoryError) or not frames or (ours and own(ours[-1].filename)):
        return None
    return located(error, (ours or frames)[-1])


def located(error: BaseException, frame: traceback.FrameSummary) -> str:
    """Return the place of a frame and the message of an exception: "plays.py line 3: KeyError: 'x'"."""
    return f"{Path(frame.filename).name} line {frame.lineno}: {type(error).__name__}: {error}"[:500]


def same_error(one: str, other: str) -> bool:
    """Return whether two results of ``author_error`` are of the same class at the same place."""
    return one.split(": ")[:2] == other.split(": ")[:2]


def checked_arrays(
    play: Callable[..., Any], seen: Any, specs: Mapping[str, Mapping[str, Any]]
) -> dict[str, NDArray[Any]]:
    """Return the arrays that ``play`` returned, as ``specs`` declares them: shape, dtype and up_to by name.

    Raises AuthorError if it returned other names, shapes or types.
    """
    code = getattr(play, "__code__", None)
    place = (
        f"{Path(code.co_filename).name} line {code.co_firstlineno}: {code.co_name}" if code else repr(play)
    )
    if not isinstance(seen, Mapping):
        raise AuthorError(f"{place} returned {type(seen).__name__}, not a dict of arrays")
    if set(seen) != set(specs):
        raise AuthorError(f"{place} returned {_listed(seen)}; the scene declares {_listed(specs)}")
    arrays = {}
    for name in seen:
        spec = specs[name]
        array, shape = np.asarray(seen[name]), tuple(spec["shape"])
        fits = array.dtype.kind in "fiub" if spec["dtype"] == "float64" else array.dtype == spec["dtype"]
        if not fits:
            raise AuthorError(
                f"{place} returned {name} with dtype {array.dtype}; the scene declares {spec['dtype']}"
            )
        if array.shape != shape and not (spec["up_to"] and _is_shorter(array.shape, shape)):
            raise AuthorError(f"{place} returned {name} with shape {array.shape}; the scene declares {shape}")
        arrays[name] = array.astype(spec["dtype"], copy=False)
    return arrays


def with_truth(seen: Sequence[Mapping[str, Any]], truth: Sequence[Mapping[str, Any]]) -> list[Any]:
    """Return the arrays of scenes with the exact ones in place of those that have the same name."""
    exact = [*truth, *[{}] * len(seen)]
    return [
        {name: np.asarray(exact[k].get(name, array)) for name, array in arrays.items()}
        for k, arrays in enumerate(seen)
    ]


def has_truth(seen: Sequence[Mapping[str, Any]], truth: Sequence[Mapping[str, Any]]) -> bool:
    """Return whether each array of the scenes has an exact one of the same name."""
    return len(truth) >= len(seen) and all(
        set(arrays) <= set(exact) for arrays, exact in zip(seen, truth, strict=False)
    )


def _listed(names: Any) -> str:
    return f"the arrays {', '.join(map(str, names))}" if names else "no array"


def _is_shorter(shape: tuple[int, ...], most: tuple[int, ...]) -> bool:
    return (
        len(shape) == len(most)
        and shape[-1:] == most[-1:]
        and all(1 <= n <= m for n, m in zip(shape, most, strict=True))
    )
