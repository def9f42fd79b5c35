"""Parts that several exercises share: places in arrays, reasons for tolerances, ω(t) and R(t) against the
exact motion.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from polhode.judging.checks import Arrays, Check, within
from polhode.kinds.animation.body import Body, follows
from polhode.kinds.animation.shown import moves

from .quantities import as_closely

NOTEBOOK = "the notebook's own tolerance"
DRIVE = "the integrator, at rtol 1e-11, stays within 1e-9 of the exact motion on this scene"

PRODUCT = "rtol × (sensitivity + angle turned) × safety, computed for each scene"


def at_time(index: tuple[int, ...], seen: Arrays) -> str:
    """Return the time of an index into a series (n,)."""
    return f"t = {seen['t'][index[0]]:z.4g} s"


def at_component(index: tuple[int, ...], seen: Arrays) -> str:
    """Return component and time of an index into ω (3, n)."""
    return f"ω{'₁₂₃'[index[0]]}, t = {seen['t'][index[1]]:z.4g} s"


def omega(id: str, label: str, scene: str) -> Check:
    """Check that ω (3, n) of a trajectory agrees with the exact motion, as closely as the scene allows any
    integrator.
    """
    return within(
        id,
        label,
        scene,
        measured=lambda seen: seen["w"],
        expected=lambda truth: truth["w"],
        scale=lambda truth: np.linalg.norm(truth["w"][:, 0]),
        limit=as_closely,
        reason=f"of |ω(0)|: {PRODUCT}",
        locate=at_component,
    )


def attitude(id: str, label: str, scene: str) -> Check:
    """Check that R (n, 3, 3) of a trajectory agrees with the exact motion, as closely as the scene allows any
    integrator.
    """
    return within(
        id,
        label,
        scene,
        measured=lambda seen: seen["R"],
        expected=lambda truth: truth["R"],
        scale=lambda truth: 1.0,
        limit=as_closely,
        reason=PRODUCT,
        locate=lambda index, seen: f"R{index[1] + 1}{index[2] + 1}, t = {seen['t'][index[0]]:z.4g} s",
    )


def filmed(given: Mapping[str, Any]) -> Body:
    """Return the body of an animation: with L its axis ê₃ is drawn, otherwise any points of a box."""
    t, R, L, half = (np.asarray(given[name]) if name in given else None for name in ("t", "R", "L", "half"))
    assert t is not None and R is not None
    return Body(t, R, None if L is None else 2, L, half)


def film(number: str, scene: str, function: str, what: str) -> tuple[Check, ...]:
    """Check that an animation moves, and that something drawn follows the body."""
    return (
        moves(f"{number}-moves", f"{function} draws a moving picture", scene),
        follows(f"{number}-follows", f"{function} draws something that follows {what}", scene, filmed),
    )
