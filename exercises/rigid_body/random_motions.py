"""Hidden motions: body, spin and time drawn for each submission, by family."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

import reference
from exercises.assignment import Inputs

Array = NDArray[np.float64]
Rng = np.random.Generator

APART = 0.05  # least relative distance of two moments that are not equal
OFF_SEPARATRIX = 0.02  # least relative distance of |L|² from 2 T I₂ in the two polhode families


def body(rng: Rng) -> Array:
    """Return moments (3,) of a box in kg m², in any order, no two nearly equal."""
    while True:
        moments = reference.box_moments(rng.uniform(2.0, 8.0), *rng.uniform(0.4, 2.0, 3))
        low, mid, high = np.sort(moments)
        if min(mid - low, high - mid) > APART * high:
            return moments


def long_run(rng: Rng) -> Inputs:
    """Draw a general motion over sixty radians."""
    w0 = _spin(rng)
    return _inputs(w0, body(rng), 60.0 / np.linalg.norm(w0), 600)


def about_least(rng: Rng) -> Inputs:
    """Draw a polhode around the axis of the least moment."""
    return _family(rng, -1)


def about_greatest(rng: Rng) -> Inputs:
    """Draw a polhode around the axis of the greatest moment."""
    return _family(rng, 1)


def symmetric(rng: Rng) -> Inputs:
    """Draw a body with two moments equal to the last bit; the third is that of any of the three axes."""
    equal = rng.uniform(0.5, 3.0)
    moments = np.full(3, equal)
    moments[rng.integers(3)] = equal * rng.choice([rng.uniform(0.2, 0.9), rng.uniform(1.1, 1.9)])
    w0 = _spin(rng)
    return _inputs(w0, moments, 20.0 / np.linalg.norm(w0), 300)


def sphere(rng: Rng) -> Inputs:
    """Draw a body with three equal moments, whose ω is constant."""
    w0 = _spin(rng)
    return _inputs(w0, np.full(3, rng.uniform(0.5, 3.0)), 10.0 / np.linalg.norm(w0), 100)


def tumble(rng: Rng) -> Inputs:
    """Draw a spin so near the intermediate axis that the body turns over once, along the separatrix."""
    moments, spin, nudge = body(rng), rng.uniform(2.0, 6.0), 10 ** rng.uniform(-4.0, -2.0)
    axis = int(np.argsort(moments)[1])
    t_end = 1.5 * np.log(4.0 / nudge) / reference.steady_spin_growth_rate(moments, axis, spin)
    while True:
        w0 = spin * nudge * rng.choice([-1.0, 1.0], 3)
        w0[axis] = spin * rng.choice([-1.0, 1.0])
        path = reference.Exact(w0, moments).omega(np.linspace(0.0, t_end, 100))[axis]
        if path.min() / spin < -0.9 and path.max() / spin > 0.9:  # with other signs it first comes nearer to the axis
            return _inputs(w0, moments, t_end, 400)


def attitude(rng: Rng) -> Inputs:
    """Draw a general motion with its attitude."""
    w0 = _spin(rng)
    return _inputs(w0, body(rng), 20.0 / np.linalg.norm(w0), 120, orientation=True)


def _family(rng: Rng, side: int) -> Inputs:
    moments = body(rng)
    while True:
        w0 = _spin(rng)
        excess = float(np.sum((moments * w0) ** 2) / (2 * reference.kinetic_energy(w0, moments) * np.median(moments))) - 1
        if side * excess > OFF_SEPARATRIX:
            return _inputs(w0, moments, 20.0 / np.linalg.norm(w0), 300)


def _spin(rng: Rng) -> Array:
    direction = rng.normal(size=3)
    return np.asarray(rng.uniform(0.8, 4.0) * direction / np.linalg.norm(direction))


def _inputs(w0: Array, moments: Array, t_end: "float | np.floating[Any]", n: int, orientation: bool = False) -> Inputs:
    return {"w0": w0.tolist(), "I": moments.tolist(), "t_end": float(t_end), "n": n, "orientation": orientation}


DRAWN: dict[str, tuple[Callable[[Rng], Inputs], int, bool]] = {
    "drawn-long": (long_run, 600, False),
    "drawn-least": (about_least, 300, False),
    "drawn-greatest": (about_greatest, 300, False),
    "drawn-symmetric": (symmetric, 300, False),
    "drawn-sphere": (sphere, 100, False),
    "drawn-tumble": (tumble, 400, False),
    "drawn-attitude": (attitude, 120, True),
}
