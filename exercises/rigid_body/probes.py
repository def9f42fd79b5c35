"""The points (t, ω, I) at which ``euler_eqs`` is called, and the accuracy required at each of them.

Random points combine each order of the moments with each octant of ω. Special points follow: on axes and
planes, at rest, with equal moments, and with very large and very small numbers. Correct formulas round
differently, so the tolerance is relative to the largest product Iω² of the point.
"""

import functools
import itertools
from collections.abc import Mapping, Sequence

import numpy as np

import reference
from exercises.assignment import Inputs
from exercises.rigid_body.draws import Rng, body, signs
from exercises.rigid_body.public.quantities import Array

ORDERS, OCTANTS = tuple(itertools.permutations(range(3))), tuple(itertools.product((-1.0, 1.0), repeat=3))
PROBES, REPEATS, RETIMED, NODES = (
    len(ORDERS) * len(OCTANTS),
    8,
    8,
    10,
)  # random; repeated; at another time; along each motion
# along a motion that is not integrated: they miss no stretch longer than 1/64 of it, about two integration
# steps
ALONG = 128
SPECIAL, MASS = 20, 6.0  # special points; of their bodies and of the random ones, in kg
EXTREME = (4.0, 5.0)  # decimal exponents of the factors that make a point large or small
AT_REST = 1e-20  # rad/s², the scale at ω = 0, where a right rate is exactly zero


def number_of_points(motions: int) -> int:
    """Return the number of points if some lie along ``motions`` exact motions."""
    return PROBES + REPEATS + RETIMED + SPECIAL + NODES * motions


def draw(rng: Rng, motions: Sequence[Inputs]) -> Inputs:
    """Return points in random order: ``t`` (n,) in s, ``w`` (n, 3) in rad/s, ``I`` (n, 3) in kg m².

    Some random points are repeated, some at another time. Others lie along ``motions``.
    """
    rows = _timed([_random(rng, order, octant) for order in ORDERS for octant in OCTANTS], rng)
    again = rng.permutation(PROBES)[: REPEATS + RETIMED]
    retimed = rows[again[REPEATS:]].copy()
    retimed[:, 0] = np.where(np.arange(RETIMED) % 2, retimed[:, 0] + 20.0, rng.uniform(0.0, 0.5, RETIMED))
    along = [_along(motion, rng) for motion in motions]
    rows = rng.permutation(
        np.concatenate([rows, rows[again[:REPEATS]], retimed, _timed(_special(rng), rng), *along])
    )
    return _columns(rows)


def exact(inputs: Inputs) -> Mapping[str, Array]:
    """Return the rates ``wdot`` (n, 3), the ``scale`` (n, 3) of their rounding, and the points themselves as
    ``at_w`` and ``at_I``.
    """
    w, I = np.asarray(inputs["w"], dtype=float), np.asarray(inputs["I"], dtype=float)
    rates = reference.euler_rhs(w.T, I.T).T
    return {"wdot": rates, "exact": rates, "scale": scale(w, I), "at_w": w, "at_I": I}


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


def along(motion: Inputs, rng: Rng) -> Inputs:
    """Return points on an exact motion, one at a random time of each of ALONG equal intervals."""
    times = (np.arange(ALONG) + rng.uniform(size=ALONG)) * motion["t_end"] / ALONG
    return _columns(_at(motion, times, rng))


def _columns(rows: Array) -> Inputs:
    return {"t": rows[:, 0], "w": rows[:, 1:4], "I": rows[:, 4:]}


def _along(motion: Inputs, rng: Rng) -> Array:
    return _at(motion, rng.uniform(0.0, motion["t_end"], NODES), rng)


def _at(motion: Inputs, times: Array, rng: Rng) -> Array:
    w = _exact(tuple(motion["w0"]), tuple(motion["I"])).omega(times)
    unrelated = rng.uniform(
        0.0, motion["t_end"], len(times)
    )  # not the motion's own times, which would identify the points
    return np.column_stack([unrelated, w.T, np.tile(motion["I"], (len(times), 1))])


@functools.lru_cache(maxsize=32)  # the fixed motions are those of every submission
def _exact(w0: tuple[float, ...], I: tuple[float, ...]) -> reference.Exact:
    return reference.Exact(w0, I)
