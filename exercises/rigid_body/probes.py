"""The points (t, ω, I) at which ``euler_eqs`` is called, and the accuracy required at each of them.

Random points combine each order of the moments with each octant of ω. Special points follow: on axes and
planes, at rest, with equal moments, and with very large and very small numbers. Correct formulas round
differently, so the tolerance is relative to the largest product Iω² of the point.
"""

import functools
import itertools
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

import reference
from exercises.authoring.assignments.assignment import Inputs
from exercises.rigid_body.draws import DRAWN, Rng, body, signs
from exercises.rigid_body.public.quantities import Array

ORDERS, OCTANTS = tuple(itertools.permutations(range(3))), tuple(itertools.product((-1.0, 1.0), repeat=3))
PROBES = len(ORDERS) * len(OCTANTS)  # random points
REPEATS, RETIMED = 8, 8  # of these: repeated, and at another time
NODES = 10  # along each motion that is integrated
# along a motion that is not: they miss no stretch longer than 1/64 of it, about two integration steps
ALONG = 128
SPECIAL, MASS = 20, 6.0  # special points; of their bodies and of the random ones, in kg
EXTREME = (4.0, 5.0)  # decimal exponents of the factors that make a point large or small
SENSED = 60  # times at which a motion's sensitivity is evaluated
AT_REST = 1e-20  # rad/s², the scale at ω = 0, where a right rate is exactly zero


class Motion(NamedTuple):
    """A motion with its start ``w0`` (3,), moments ``I`` (3,) and duration ``t_end``, with or without its
    attitude.
    """

    w0: tuple[float, ...]
    I: tuple[float, ...]
    t_end: float
    orientation: bool

    @classmethod
    def of(cls, inputs: Inputs) -> "Motion":
        """Return the motion of a scene's inputs."""
        return cls(tuple(inputs["w0"]), tuple(inputs["I"]), inputs["t_end"], inputs["orientation"])


def number_of_points(integrated: int) -> int:
    """Return the number of points for so many motions that are integrated."""
    return PROBES + REPEATS + RETIMED + SPECIAL + NODES * integrated + ALONG * len(DRAWN)


def draw(rng: Rng, integrated: Mapping[str, Inputs]) -> Inputs:
    """Return points in random order: ``t`` (n,) in s, ``w`` (n, 3) in rad/s, ``I`` (n, 3) in kg m².

    Some random points are repeated, some at another time. Others lie along the motions ``integrated`` and
    those that are drawn: ``motions`` are these by name, ``rows`` the indices of their points.
    """
    rows = _timed([_random(rng, order, octant) for order in ORDERS for octant in OCTANTS], rng)
    again = rng.permutation(PROBES)[: REPEATS + RETIMED]
    retimed = rows[again[REPEATS:]].copy()
    retimed[:, 0] = np.where(np.arange(RETIMED) % 2, retimed[:, 0] + 20.0, rng.uniform(0.0, 0.5, RETIMED))
    motions = {name: Motion.of(inputs) for name, inputs in integrated.items()}
    drawn = {name: Motion.of(draw(rng)) for name, draw in DRAWN.items()}
    along = [_along(motion, np.sort(rng.uniform(size=NODES)), rng) for motion in motions.values()]
    along += [
        _along(motion, (np.arange(ALONG) + rng.uniform(size=ALONG)) / ALONG, rng) for motion in drawn.values()
    ]
    others = [rows, rows[again[:REPEATS]], retimed, _timed(_special(rng), rng)]
    parts = [*others, *along]
    order = rng.permutation(sum(map(len, parts)))
    which = np.repeat(np.arange(len(parts)) - len(others), [len(part) for part in parts])[order]
    t, w, I = np.split(np.concatenate(parts)[order], (1, 4), axis=1)
    places = {name: np.flatnonzero(which == k) for k, name in enumerate(motions | drawn)}
    return {"t": t[:, 0], "w": w, "I": I, "motions": motions | drawn, "rows": places}


def exact(inputs: Inputs) -> Mapping[str, Array]:
    """Return the rates ``wdot`` (n, 3), the ``scale`` (n, 3) of their rounding, the points themselves as
    ``at_w`` and ``at_I``, and what ``bounds.py`` needs of each motion.
    """
    w, I = np.asarray(inputs["w"], dtype=float), np.asarray(inputs["I"], dtype=float)
    rates = reference.euler_rhs(w.T, I.T).T
    found = {"wdot": rates, "exact": rates, "scale": scale(w, I), "at_w": w, "at_I": I}
    for name, motion in inputs["motions"].items():
        found |= {f"{name}: rows": inputs["rows"][name]}
        found |= {f"{name}: {quantity}": value for quantity, value in sensitivity(motion).items()}
    return found


@functools.lru_cache(maxsize=64)  # the integrated motions are those of every submission
def sensitivity(motion: Motion) -> Mapping[str, Array]:
    """Return the sensitivity ``kappa`` of a motion to errors, its counterpart ``duration`` in s, the initial
    ``speed`` in rad/s, the ``angle`` in rad turned at it, and ``turned``: how much larger the error of the
    attitude is, if that is asked for.
    """
    kappa, duration = reference.sensitivities(motion.w0, motion.I, motion.t_end, SENSED)
    speed = float(np.linalg.norm(motion.w0))
    angle = speed * motion.t_end
    found = {"kappa": kappa, "duration": duration, "speed": speed, "angle": angle}
    found["turned"] = max(1.0, angle) if motion.orientation else 1.0
    return {name: np.array(value) for name, value in found.items()}


def without_drawn(inputs: Inputs, answers: Array) -> tuple[Inputs, Array]:
    """Return points and answers without those along drawn motions, of which there are so many that they
    would hide where a function is right.
    """
    along = np.concatenate([inputs["rows"][name] for name in DRAWN])
    others = np.setdiff1d(np.arange(len(answers)), along)
    return {name: inputs[name][others] for name in ("t", "w", "I")}, answers[others]


def scale(w: Array, I: Array) -> Array:
    """Return the largest product Iω² of each point over each moment (n, 3) in rad/s², a bound for rounding in
    every correct formula.
    """
    return np.asarray(
        np.maximum(I.max(axis=1, keepdims=True) * np.abs(w).max(axis=1, keepdims=True) ** 2 / I, AT_REST)
    )


def _random(rng: Rng, order: tuple[int, ...], octant: tuple[float, ...]) -> tuple[Array, Array]:
    spin = 10 ** rng.uniform(-1.0, 1.5) * rng.uniform(0.2, 1.0, 3)
    moments = sorted(body(rng, MASS).tolist())
    return spin * octant, np.array([moments[k] for k in order])


def _special(rng: Rng) -> list[tuple[Array, Array]]:
    def spin() -> Array:
        return np.asarray(rng.uniform(0.5, 3.0, 3) * signs(rng))

    axes = np.eye(3)
    found = [(mask * spin(), body(rng, MASS)) for mask in (*axes, *(1 - axes))]
    found += [(np.where(axis > 0, 1e-3 * spin(), spin()), body(rng, MASS)) for axis in axes]
    found.append((np.zeros(3), body(rng, MASS)))
    for axis in axes:
        equal = rng.uniform(0.5, 3.0)
        found.append(
            (
                spin(),
                np.where(axis > 0, equal * rng.choice([rng.uniform(0.3, 0.8), rng.uniform(1.2, 1.9)]), equal),
            )
        )
    found.append((spin(), np.full(3, rng.uniform(0.5, 3.0))))
    for faster, heavier in ((1, 0), (-1, 0), (0, 1), (0, -1), (1, -1), (-1, 1)):
        size, weight = 10.0 ** (np.array([faster, heavier]) * rng.uniform(*EXTREME, 2))
        found.append((size * spin(), weight * body(rng, MASS)))
    return found


def _timed(points: list[tuple[Array, Array]], rng: Rng) -> Array:
    spins, moments = (np.array(column) for column in zip(*points, strict=True))
    return np.column_stack([rng.uniform(0.0, 20.0, len(points)), spins, moments])


def _along(motion: Motion, parts: Array, rng: Rng) -> Array:
    """Return points on an exact motion after these ``parts`` (n,) of its duration."""
    w = _exact(motion.w0, motion.I).omega(parts * motion.t_end)
    unrelated = rng.uniform(0.0, motion.t_end, len(parts))  # its own times would identify the points
    return np.column_stack([unrelated, w.T, np.tile(motion.I, (len(parts), 1))])


@functools.lru_cache(maxsize=32)  # the fixed motions are those of every submission
def _exact(w0: tuple[float, ...], I: tuple[float, ...]) -> reference.Exact:
    return reference.Exact(w0, I)
