"""The animation of a symmetric top that a notebook's cell shows, in place of the function that is asked for.

That cell, a function it calls, or the one that draws its frames names attitudes R (n, 3, 3) whose ê₃ runs
on a circle, or that ê₃. Their times and the moments may be anywhere in the notebook; names of the cell come
first.
"""

import inspect
import re
import types
from collections.abc import Mapping
from typing import Any

import numpy as np

from polhode.animation import animate
from polhode.judging.integration import Array

MOST_OWN = 4000  # samples of a notebook's own motion
UNKNOWN = np.zeros((2, 3, 3))  # replaces the attitudes of an animation if they are not known
NOT_OWN = {"own_R": np.zeros((1, 3, 3)), "own_t": np.zeros((1, 1)), "own_I": np.zeros((1, 3))}


class FromCell:
    """An animation that a cell showed, used if there is no function; ``own`` are numbers of the notebook."""

    def __init__(self, anim: Any, own: Mapping[str, Array]) -> None:
        self.anim, self.own = anim, own

    def __call__(self, *given: Any) -> Any:
        """Return the animation, which was drawn from the notebook's own numbers."""
        return self.anim


def adopt(function: str, student: Mapping[str, Any], source: str) -> dict[str, FromCell]:
    """Return the ``function`` that stands for the animation that the cell ``source`` shows, none if it shows
    another motion.

    If only other cells name such attitudes, the animation has UNKNOWN ones.
    """
    if not animate.shown:
        return {}
    mentioned = set(re.findall(r"\w+", source))
    called = (student.get(name) for name in tuple(mentioned))
    for one in [one for one in called if isinstance(one, types.FunctionType)]:
        mentioned |= _names(one.__code__)
    drawing = getattr(animate.shown[-1], "_func", None)  # of an animation made inside a function
    drawing = getattr(drawing, "func", drawing)  # matplotlib has a functools.partial
    held = inspect.getclosurevars(drawing).nonlocals if isinstance(drawing, types.FunctionType) else {}
    mentioned |= held.keys()
    values = {**student, **held}
    numbers = {name: _numbers(value) for name, value in values.items() if not name.startswith("_")}
    arrays = {name: array for name, array in numbers.items() if array is not None}
    named = [arrays[name] for name in sorted(arrays, key=lambda name: name not in mentioned)]
    used = [array for name, array in arrays.items() if name in mentioned]
    cones = [x for x in named if _is_cone(x)]
    if not cones:
        return {}
    R = next((x for x in cones if _uses(used, x)), UNKNOWN)
    if R is UNKNOWN and function in student:
        return {}  # the function is to be written yet, and the cell shows something else
    times = [x for x in named if x.shape == (len(R),) and np.all(np.diff(x) > 0)]
    moments = [x for x in named if x.shape == (3,) and np.all(x > 0)][:8]
    own = {
        "own_R": R,
        "own_t": times[0][:, None] if times else np.zeros((1, 1)),
        "own_I": np.array(moments or np.zeros((1, 3))),
    }
    return {function: FromCell(animate.shown[-1], own)}


def _names(code: types.CodeType) -> set[str]:
    return {*code.co_names, *code.co_freevars}.union(
        *(_names(part) for part in code.co_consts if isinstance(part, types.CodeType))
    )


def _is_cone(R: Array) -> bool:
    """Return whether the ê₃ of R (n, 3, 3) runs on a circle."""
    if R.ndim != 3 or R.shape[1:] != (3, 3) or not 10 <= len(R) <= MOST_OWN:
        return False
    sizes = np.linalg.svd(R[:, :, 2] - R[:, :, 2].mean(axis=0), compute_uv=False)
    return bool(sizes[2] <= 1e-3 * sizes[0])


def _uses(used: list[Array], R: Array) -> bool:
    tips = (R[:, :, 2], R[:, :, 2].T)
    return any(x is R or any(x.shape == tip.shape and np.allclose(x, tip) for tip in tips) for x in used)


def _numbers(value: Any) -> Array | None:
    """Return the finite real array that a value is, or None."""
    if not isinstance(value, np.ndarray | list | tuple) or len(value) == 0 or len(value) > MOST_OWN:
        return None
    try:
        array = np.array(value)
    except ValueError:
        return None
    real = array.dtype.kind in "fiu" and array.size <= 9 * MOST_OWN and bool(np.all(np.isfinite(array)))
    return array.astype(float) if real else None
