"""What each grading draws: boxes, tensors, points and motions of ``euler_eqs``, and motions (t, ω) for
``precession_rate``.
"""

import itertools
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

import reference
from exercises.authoring.draws import Drawing
from polhode.judging.integration import Array

Rng = np.random.Generator
Drawn = dict[str, Any]

UNEQUAL = 8  # boxes with no two moments nearly equal
APART = 0.05  # least relative distance of two moments that are not equal
OFF_SEPARATRIX = 0.02  # least relative distance of |L|² from 2 T I₂ in the two polhode families
REPEATED = 8  # points that are asked twice, and at another time
MASS = 6.0  # of the bodies of points, in kg
EXTREME = (4.0, 5.0)  # decimal exponents of the factors that make a point large or small

TURN_SAMPLES = 600
UNEVEN = 0.5  # of a given precession: the longest of its uneven steps is four times the shortest
SWAY = 0.006  # relative variation of an uneven rate of turn
SWAYS = 2.5  # its number of periods, a half-integer


def boxes(draw: Drawing) -> Iterator[Drawn]:
    """Yield boxes: some with no two moments nearly equal, then cubes, equal edges, plates, bars, large and
    small ones.
    """
    for _ in range(UNEQUAL):
        yield _box(*_unequal_box(draw.rng))
    for _ in range(2):
        m, a, b, c = _unequal_box(draw.rng)
        long, thin = 20 * max(a, b, c), min(a, b, c) / 20
        for edges in ((a, a, a), (b, a, a), (a, b, a), (a, a, b), (a, b, thin), (long, b, c)):
            yield _box(m, *edges)
    for mass, length in ((1e3, 1e3), (1e-3, 1e-3), (1e-3, 1e3), (1e3, 1e-3)):
        m, a, b, c = _unequal_box(draw.rng)
        yield _box(m * mass, a * length, b * length, c * length)


def tensors(draw: Drawing) -> Iterator[Drawn]:
    """Yield the tensors of tilted boxes, of two boxes that are not tilted, and of a large and a small box.

    No two moments are nearly equal: the roots of the characteristic polynomial would lose half their digits
    or become complex.
    """
    given = [_unequal_box(draw.rng) for _ in range(UNEQUAL)]
    tilted = [reference.box_tensor(*box, rotation(draw.rng)) for box in given]
    straight = [np.diag(reference.box_moments(*box)) for box in given[:2]]
    sizes = [1.0] * len(tilted + straight) + [1e2, 1e-2]
    for size, tensor in zip(sizes, [*tilted, *straight, *tilted[:2]], strict=True):
        yield {"tensor": size * np.asarray(tensor)}


def _box(m: float, a: float, b: float, c: float) -> Drawn:
    return {"m": m, "a": a, "b": b, "c": c}


def _unequal_box(rng: Rng) -> tuple[float, float, float, float]:
    found = ((rng.uniform(0.5, 3.0), *rng.uniform(0.2, 3.0, 3).tolist()) for _ in itertools.count())
    return next(box for box in found if _are_apart(reference.box_moments(*box)))


def rotation(rng: Rng) -> Array:
    """Return a random rotation (3, 3)."""
    Q = np.linalg.qr(rng.random((3, 3)))[0]
    return np.asarray(Q * np.linalg.det(Q))


def points(draw: Drawing) -> Iterator[Drawn]:
    """Yield points (t, ω, I): each order of the moments with each octant of ω, some of them again and some at
    another time; then special ones.
    """
    rng, orders = draw.rng, itertools.permutations(range(3))
    drawn = [
        _timed(*_random(rng, order, octant), rng)
        for order in orders
        for octant in itertools.product((-1.0, 1.0), repeat=3)
    ]
    yield from drawn
    again = rng.permutation(len(drawn))[: 2 * REPEATED]
    yield from (drawn[k] for k in again[:REPEATED])
    for k in again[REPEATED:]:
        yield drawn[k] | {"t": drawn[k]["t"] + 20.0 if k % 2 else rng.uniform(0.0, 0.5)}
    for spin, moments in _special(rng):
        yield _timed(spin, moments, rng)


def _timed(spin: Array, moments: Array, rng: Rng) -> Drawn:
    return {"t": rng.uniform(0.0, 20.0), "w": spin, "I": moments}


def _random(rng: Rng, order: tuple[int, ...], octant: tuple[float, ...]) -> tuple[Array, Array]:
    spin = 10 ** rng.uniform(-1.0, 1.5) * rng.uniform(0.2, 1.0, 3)
    moments = sorted(_body(rng, MASS).tolist())
    return spin * octant, np.array([moments[k] for k in order])


def _special(rng: Rng) -> Iterator[tuple[Array, Array]]:
    """Yield points on axes, on planes, near planes, at rest, with two and with three equal moments, and with
    very large and very small numbers.
    """

    def spin() -> Array:
        return np.asarray(rng.uniform(0.5, 3.0, 3) * rng.choice([-1.0, 1.0], 3))

    axes = np.eye(3)
    for mask in (*axes, *(1 - axes)):
        yield mask * spin(), _body(rng, MASS)
    for axis in axes:
        yield np.where(axis > 0, 1e-3 * spin(), spin()), _body(rng, MASS)
    yield np.zeros(3), _body(rng, MASS)
    for axis in axes:
        equal, ratio = rng.uniform(0.5, 3.0), rng.choice([rng.uniform(0.3, 0.8), rng.uniform(1.2, 1.9)])
        yield spin(), np.where(axis > 0, equal * ratio, equal)
    yield spin(), np.full(3, rng.uniform(0.5, 3.0))
    for faster, heavier in ((1, 0), (-1, 0), (0, 1), (0, -1), (1, -1), (-1, 1)):
        size, weight = 10.0 ** (np.array([faster, heavier]) * rng.uniform(*EXTREME, 2))
        yield size * spin(), weight * _body(rng, MASS)


def _body(rng: Rng, mass: float | None = None) -> Array:
    """Return moments (3,) of a box in kg m², in any order, no two nearly equal. Its ``mass`` in kg is drawn
    too unless given.
    """
    found = (
        reference.box_moments(mass or rng.uniform(2.0, 8.0), *rng.uniform(0.4, 2.0, 3).tolist())
        for _ in itertools.count()
    )
    return next(filter(_are_apart, found))


def _are_apart(moments: Array) -> bool:
    least, middle, greatest = sorted(moments.tolist())
    return bool(min(middle - least, greatest - middle) > APART * greatest)


def _spin(rng: Rng) -> Array:
    direction = rng.normal(size=3)
    return np.asarray(rng.uniform(0.8, 4.0) * direction / np.linalg.norm(direction))


def _turning_over(angle: float, w: Array, I: Array) -> Drawn:
    return {"w": w, "I": I, "until": float(angle / np.linalg.norm(w))}


def long(draw: Drawing) -> Drawn:
    """Return a general motion over sixty radians."""
    return _turning_over(60.0, _spin(draw.rng), _body(draw.rng))


def greatest(draw: Drawing) -> Drawn:
    """Return a polhode around the axis of the greatest moment."""
    return _about_axis(1, draw.rng)


def least(draw: Drawing) -> Drawn:
    """Return a polhode around the axis of the least moment."""
    return _about_axis(-1, draw.rng)


def _about_axis(side: int, rng: Rng) -> Drawn:
    """Return a polhode on one ``side`` of the separatrix, where |L|² = 2 T I₂."""
    moments = _body(rng)

    def excess(w: Array) -> float:
        L2 = np.sum((moments * w) ** 2)
        return float(L2 / (2 * reference.kinetic_energy(w, moments) * np.median(moments))) - 1

    spins = (_spin(rng) for _ in itertools.count())
    return _turning_over(20.0, next(w for w in spins if side * excess(w) > OFF_SEPARATRIX), moments)


def symmetric_top(draw: Drawing) -> Drawn:
    """Return a motion of a symmetric top: I₁ and I₂ are equal to the last bit. The axis of symmetry is always
    ê₃.

    That component of ω̇ is zero, so with any other axis an error in one component would pass for some
    students only.
    """
    rng = draw.rng
    equal = rng.uniform(0.5, 3.0)
    third = equal * rng.choice([rng.uniform(0.2, 0.9), rng.uniform(1.1, 1.9)])
    return _turning_over(20.0, _spin(rng), np.array([equal, equal, third]))


def sphere(draw: Drawing) -> Drawn:
    """Return a motion of a body with three equal moments, whose ω is constant."""
    return _turning_over(10.0, _spin(draw.rng), np.full(3, draw.rng.uniform(0.5, 3.0)))


def tumble(draw: Drawing) -> Drawn:
    """Return a spin so near the intermediate axis that the body turns over once, along the separatrix."""
    rng = draw.rng
    moments, spin, nudge = _body(rng), rng.uniform(2.0, 6.0), 10 ** rng.uniform(-4.0, -2.0)
    axis = int(np.argsort(moments)[1])
    until = float(1.5 * np.log(4.0 / nudge) / reference.steady_spin_growth_rate(moments, axis, spin))
    while True:
        w = np.asarray(spin * nudge * rng.choice([-1.0, 1.0], 3), float)
        w[axis] = spin * rng.choice([-1.0, 1.0])
        path = reference.Exact(w, moments).omega(np.linspace(0.0, until, 100))[axis]
        if path.min() / spin < -0.9 and path.max() / spin > 0.9:  # with other signs it first comes nearer
            return {"w": w, "I": moments, "until": until}


def attitude(draw: Drawing) -> Drawn:
    """Return a general motion over twenty radians, whose attitude is asked for."""
    return _turning_over(20.0, _spin(draw.rng), _body(draw.rng))


def uneven_times(draw: Drawing) -> Drawn:
    """Return a forward precession at uneven times of even turning: the last steps are much longer than the
    first, or the first ones.
    """
    samples = np.linspace(0.0, 1.0, TURN_SAMPLES)
    times = (1 - UNEVEN) * samples + UNEVEN * samples**3
    return _turning((1.1, 1.9), times if draw.rng.random() < 0.5 else 1 - times[::-1], 0.0, draw.rng)


def backwards(draw: Drawing) -> Drawn:
    """Return a backward precession at even times whose rate varies; its mean, slope and median are the
    same.
    """
    return _turning((0.3, 0.8), np.linspace(0.0, 1.0, TURN_SAMPLES), draw.sign() * SWAY, draw.rng)


def coarse(draw: Drawing) -> Drawn:
    """Return a precession at 21 samples, steps of nearly half a turn: ten of them jump past ±π."""
    return _even(20, (0.46, 0.468), 9, 21, draw.rng)


def short(draw: Drawing) -> Drawn:
    """Return less than one turn of a precession, through ±π."""
    return _even(1, (0.6, 0.9), 0, 100, draw.rng)


def _even(steps: int, step: tuple[float, float], late: int, samples: int, rng: Rng) -> Drawn:
    """Return ω (3, n) turning at an even rate, forward or backward, at even times (n,) that do not start at
    zero.

    Each of the ``steps`` is a share of a turn within the limits ``step``. The angle passes ±π for the first
    time before the last ``late`` turns.
    """
    turns = steps * rng.uniform(*step)
    before = rng.uniform(0.1, 0.9) * (turns - late)
    part, duration = np.linspace(0.0, 1.0, samples), turns * rng.uniform(2.0, 6.0)
    angle = rng.choice([-1.0, 1.0]) * np.pi * (1 - 2 * before + 2 * turns * part)
    return _given(duration * (rng.uniform(0.5, 1.5) + part), angle, rng.uniform(1.0, 4.0), rng)


def _turning(i3: tuple[float, float], part: Array, sway: float, rng: Rng) -> Drawn:
    """Return ω (3, n) of a symmetric top with I₃ / I₁ within the limits ``i3``, over two to three turns, so
    that a phase that is not unwrapped jumps, at times (n,) that do not start at zero.

    ``part`` are the times from 0 to 1. The rate of turn varies by ``sway``, in two and a half periods about
    the middle. It is odd there, so every way of taking the mean (slope, total, median) gives the same number.
    """
    ratio, w3 = rng.uniform(*i3), rng.uniform(1.0, 4.0)
    rate, turns = reference.free_precession_rate((1.0, 1.0, ratio), w3), rng.uniform(2.2, 2.9)
    duration = turns * 2 * np.pi / abs(rate)
    ahead = sway * rate * duration / (2 * np.pi * SWAYS) * np.cos(2 * np.pi * SWAYS * (part - 0.5))
    angle = rng.uniform(0.0, 6.0) + rate * duration * part + ahead
    return _given(duration * (rng.uniform(0.5, 1.5) + part), angle, w3, rng)


def _given(t: Array, angle: Array, w3: float, rng: Rng) -> Drawn:
    transverse = rng.uniform(0.1, 0.8)
    w = np.array([transverse * np.cos(angle), transverse * np.sin(angle), np.full_like(t, w3)])
    return {"t": t, "w": w}


PRECESSIONS: dict[str, Callable[[Drawing], Drawn]] = {
    "function": uneven_times,
    "retrograde": backwards,
    "coarse": coarse,
    "short": short,
}
"""The given precessions, by the name of the check."""
