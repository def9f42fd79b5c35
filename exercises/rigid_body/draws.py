"""The inputs drawn for each submission: boxes, tensors, motions by family, and motions (t, ω) for
``precession_rate``.
"""

import itertools
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import reference
from exercises.authoring.assignments.assignment import Inputs
from exercises.rigid_body.public.quantities import Array

Rng = np.random.Generator

UNEQUAL = 8  # boxes with no two moments nearly equal
BOXES, TENSORS = UNEQUAL + 16, UNEQUAL + 4  # inputs of box_moments and of principal_moments
APART = 0.05  # least relative distance of two moments that are not equal
OFF_SEPARATRIX = 0.02  # least relative distance of |L|² from 2 T I₂ in the two polhode families

TURN_SAMPLES, UNEVEN = (
    600,
    0.5,
)  # of a given precession; the longest of its uneven steps is four times the shortest
SWAY, SWAYS = (
    0.006,
    2.5,
)  # relative variation of an uneven rate of turn, and its number of periods, a half-integer
COARSE_SAMPLES, COARSE_STEP = (
    21,
    (0.46, 0.468),
)  # of a turn from sample to sample, less than half with a margin for fits
SHORT_SAMPLES, SHORT_TURNS = 100, (0.6, 0.9)


def boxes(rng: np.random.Generator) -> Inputs:
    """Draw boxes (m, a, b, c): some with no two moments nearly equal, then cubes, equal edges, plates, bars,
    large and small ones.
    """
    drawn: list[ArrayLike] = [_unequal_box(rng) for _ in range(UNEQUAL)]
    for m, a, b, c in (_unequal_box(rng) for _ in range(2)):
        long, thin = 20 * max(a, b, c), min(a, b, c) / 20
        drawn += [(m, a, a, a), (m, b, a, a), (m, a, b, a), (m, a, a, b), (m, a, b, thin), (m, long, b, c)]
    sizes = [(1e3, 1e3), (1e-3, 1e-3), (1e-3, 1e3), (1e3, 1e-3)]
    drawn += [np.array(_unequal_box(rng)) * [mass, *[length] * 3] for mass, length in sizes]
    return {"boxes": np.array(drawn)}


def tensors(rng: np.random.Generator) -> Inputs:
    """Draw tilted boxes, some of them diagonal already or of other sizes.

    No two moments are nearly equal: the roots of the characteristic polynomial would lose half their digits
    or become complex.
    """
    boxes = np.array([_unequal_box(rng) for _ in range(UNEQUAL)])
    given = [
        *np.asarray(tilted(boxes, rng)["tensors"]),
        *(np.diag(reference.box_moments(*box)) for box in boxes[:2]),
    ]
    given += [size * tensor for size, tensor in zip((1e2, 1e-2), given, strict=False)]
    return {"tensors": np.array(given)}


def tilted(boxes: Array, rng: np.random.Generator) -> Inputs:
    """Return the tensors of boxes (m, a, b, c) (n, 4), each turned at random."""
    return {"tensors": [reference.box_tensor(m, a, b, c, _rotation(rng)).tolist() for m, a, b, c in boxes]}


def _unequal_box(rng: np.random.Generator) -> tuple[float, ...]:
    boxes = ((rng.uniform(0.5, 3.0), *rng.uniform(0.2, 3.0, 3)) for _ in itertools.count())
    return next(box for box in boxes if are_apart(reference.box_moments(*box)))


def _rotation(rng: np.random.Generator) -> Array:
    Q = np.linalg.qr(rng.random((3, 3)))[0]
    return np.asarray(Q * np.linalg.det(Q))


def body(rng: Rng, mass: float | None = None) -> Array:
    """Return moments (3,) of a box in kg m², in any order, no two nearly equal. Its ``mass`` in kg is drawn
    too unless given.
    """
    boxes = (
        reference.box_moments(mass or rng.uniform(2.0, 8.0), *rng.uniform(0.4, 2.0, 3).tolist())
        for _ in itertools.count()
    )
    return next(filter(are_apart, boxes))


def signs(rng: Rng) -> Array:
    """Draw three signs: -1.0 or 1.0, as ``rng.choice`` does, in a quarter of its time."""
    return np.asarray(2.0 * rng.integers(0, 2, 3) - 1.0, dtype=float)


def are_apart(moments: Array) -> bool:
    """Return whether no two moments are nearly equal."""
    least, middle, greatest = sorted(moments.tolist())
    return bool(min(middle - least, greatest - middle) > APART * greatest)


def general(angle: float, orientation: bool, rng: Rng) -> Inputs:
    """Draw a general motion over ``angle`` in rad, with its attitude if ``orientation`` is set."""
    return _inputs(_spin(rng), body(rng), angle, orientation)


def about_axis(side: int, rng: Rng) -> Inputs:
    """Draw a polhode around the axis of the least moment (``side`` −1) or of the greatest (1)."""
    moments = body(rng)

    def excess(w0: Array) -> float:
        return (
            float(
                np.sum((moments * w0) ** 2) / (2 * reference.kinetic_energy(w0, moments) * np.median(moments))
            )
            - 1
        )

    spins = (_spin(rng) for _ in itertools.count())
    return _inputs(next(w0 for w0 in spins if side * excess(w0) > OFF_SEPARATRIX), moments, 20.0)


def symmetric(rng: Rng) -> Inputs:
    """Draw a symmetric top: I₁ and I₂ are equal to the last bit. The axis of symmetry is always ê₃.

    That component of ω̇ is zero, so with any other axis an error in one component would pass for some
    students only.
    """
    equal = rng.uniform(0.5, 3.0)
    third = equal * rng.choice([rng.uniform(0.2, 0.9), rng.uniform(1.1, 1.9)])
    return _inputs(_spin(rng), np.array([equal, equal, third]), 20.0)


def sphere(rng: Rng) -> Inputs:
    """Draw a body with three equal moments, whose ω is constant."""
    return _inputs(_spin(rng), np.full(3, rng.uniform(0.5, 3.0)), 10.0)


def tumble(rng: Rng) -> Inputs:
    """Draw a spin so near the intermediate axis that the body turns over once, along the separatrix."""
    moments, spin, nudge = body(rng), rng.uniform(2.0, 6.0), 10 ** rng.uniform(-4.0, -2.0)
    axis = int(np.argsort(moments)[1])
    t_end = 1.5 * np.log(4.0 / nudge) / reference.steady_spin_growth_rate(moments, axis, spin)
    while True:
        w0 = np.asarray(spin * nudge * rng.choice([-1.0, 1.0], 3), float)
        w0[axis] = spin * rng.choice([-1.0, 1.0])
        path = reference.Exact(w0, moments).omega(np.linspace(0.0, t_end, 100))[axis]
        if (
            path.min() / spin < -0.9 and path.max() / spin > 0.9
        ):  # with other signs it first comes nearer to the axis
            return _inputs(w0, moments, 0.0) | {"t_end": float(t_end)}


def _spin(rng: Rng) -> Array:
    direction = rng.normal(size=3)
    return np.asarray(rng.uniform(0.8, 4.0) * direction / np.linalg.norm(direction))


def _inputs(w0: Array, moments: Array, angle: float, orientation: bool = False) -> dict[str, Any]:
    t_end = float(angle / np.linalg.norm(w0))
    return {"w0": w0.tolist(), "I": moments.tolist(), "t_end": t_end, "orientation": orientation}


DRAWN: dict[str, Callable[[Rng], Inputs]] = {
    "long": partial(general, 60.0, False),
    "least": partial(about_axis, -1),
    "greatest": partial(about_axis, 1),
    "symmetric top": symmetric,
    "sphere": sphere,
    "tumble": tumble,
    "attitude": partial(general, 20.0, True),
}
"""Motions that are not integrated: ``euler_eqs`` is asked for its value at points along them."""


def uneven(rng: Rng) -> tuple[Array, float]:
    """Draw uneven times (n,), from 0 to 1, of even turning: the last steps are much longer than the first, or
    the first ones.
    """
    samples = np.linspace(0.0, 1.0, TURN_SAMPLES)
    times = (1 - UNEVEN) * samples + UNEVEN * samples**3
    return times if rng.random() < 0.5 else 1 - times[::-1], 0.0


def swaying(rng: Rng) -> tuple[Array, float]:
    """Draw even times (n,), from 0 to 1, of turning at a varying rate; its mean, slope and median are the
    same.
    """
    return np.linspace(0.0, 1.0, TURN_SAMPLES), rng.choice([-1.0, 1.0]) * SWAY


def even(steps: int, step: tuple[float, float], late: int, samples: int, rng: Rng) -> Inputs:
    """Draw ω (3, n) turning at an even rate, forward or backward, at even times (n,) that do not start at
    zero.

    Each of the ``steps`` is a share of a turn within the limits ``step``. The angle passes ±π for the first
    time before the last ``late`` turns.
    """
    turns = steps * rng.uniform(*step)
    before = rng.uniform(0.1, 0.9) * (turns - late)
    part, transverse, w3 = np.linspace(0.0, 1.0, samples), rng.uniform(0.1, 0.8), rng.uniform(1.0, 4.0)
    duration, angle = (
        turns * rng.uniform(2.0, 6.0),
        rng.choice([-1.0, 1.0]) * np.pi * (1 - 2 * before + 2 * turns * part),
    )
    w = np.array([transverse * np.cos(angle), transverse * np.sin(angle), np.full_like(part, w3)])
    return {"t": duration * (rng.uniform(0.5, 1.5) + part), "w": w}


def turning(i3: tuple[float, float], times: Callable[[Rng], tuple[Array, float]], rng: Rng) -> Inputs:
    """Draw ω (3, n) of a symmetric top with I₃ / I₁ within the limits ``i3``, over two to three turns, so
    that a phase that is not unwrapped jumps, at times (n,) that do not start at zero.

    ``times`` draws them from 0 to 1, and how much the rate of turn varies, in two and a half periods about
    the middle. It is odd there, so every way of taking the mean (slope, total, median) gives the same number.
    """
    ratio, w3 = rng.uniform(*i3), rng.uniform(1.0, 4.0)
    (part, sway), rate = times(rng), reference.free_precession_rate((1.0, 1.0, ratio), w3)
    transverse, phase, turns = rng.uniform(0.1, 0.8), rng.uniform(0.0, 6.0), rng.uniform(2.2, 2.9)
    duration = turns * 2 * np.pi / abs(rate)
    ahead = sway * rate * duration / (2 * np.pi * SWAYS) * np.cos(2 * np.pi * SWAYS * (part - 0.5))
    angle = phase + rate * duration * part + ahead
    w = np.array([transverse * np.cos(angle), transverse * np.sin(angle), np.full_like(part, w3)])
    return {"t": duration * (rng.uniform(0.5, 1.5) + part), "w": w}


TURNING: dict[str, Callable[[Rng], Inputs]] = {
    "rate": partial(turning, (1.1, 1.9), uneven),
    "rate-retrograde": partial(turning, (0.3, 0.8), swaying),
    # ten of the twenty steps, each of nearly half a turn, jump past ±π
    "rate-coarse": partial(even, COARSE_SAMPLES - 1, COARSE_STEP, 9, COARSE_SAMPLES),
    "rate-short": partial(even, 1, SHORT_TURNS, 0, SHORT_SAMPLES),  # through less than one turn,
}
