"""What a student's function returned, taken strictly: a real array of just the asked shape, or a sentence saying what is wrong."""

from typing import Any

import numpy as np
from numpy.typing import NDArray


class WrongAnswer(Exception):
    """The function answered, but not with what was asked for. ``code`` is the public diagnosis code, if one fits."""

    def __init__(self, code: str | None, sentence: str) -> None:
        super().__init__(sentence)
        self.code = code


def real_array(value: Any, shape: tuple[int, ...], name: str) -> NDArray[np.float64]:
    """``value`` as float64 of exactly ``shape``; lists and tuples of numbers are fine, broadcasting and casting are not."""
    if value is None:
        raise WrongAnswer("returns-nothing", f"{name} returned None: is a return statement missing?")
    try:
        array = np.asarray(value)
    except ValueError:
        raise WrongAnswer("wrong-shape", f"{name} returned a ragged list; expected shape {shape}") from None
    if array.dtype.kind not in "fiu":
        raise WrongAnswer("wrong-shape", f"{name} must return real numbers; it returned {_kind(value, array)}")
    if array.shape != shape:
        raise WrongAnswer("wrong-shape", f"{name} must return shape {shape}; it returned shape {array.shape}")
    return np.array(array, dtype=np.float64)


def _kind(value: Any, array: NDArray[Any]) -> str:
    return f"dtype {array.dtype}" if isinstance(value, np.ndarray) else f"a {type(value).__name__}"
