"""Where a function is right: a condition on the order of the moments, the signs and zeros of ω, or a size."""

import itertools
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

import reference
from exercises.rigid_body.causes.agreement import Mask
from exercises.rigid_body.causes.errors import COMPONENT, MOMENT, SPIN

Array = NDArray[np.float64]
LEAST_POINTS = 3  # on each side of a threshold
PLACE = ("smallest", "middle", "largest")


def described(inside: Mask, outside: Mask, w: Array, moments: Array) -> str | None:
    """Return in words what holds at all points ``inside`` (n,) and at none ``outside``, or None.

    Of several thresholds that hold, the first two are named.
    """
    if not inside.any():
        return None
    for name, where in _conditions(w, moments):
        if np.all(where[inside]) and not np.any(where[outside]):
            return name
    if min(inside.sum(), outside.sum()) < LEAST_POINTS:
        return None
    found = [text for name, size in _sizes(w, moments) if (text := _threshold(name, size, inside, outside))]
    return " or ".join(found[:2]) or None


def _conditions(w: Array, moments: Array) -> Iterator[tuple[str, Mask]]:
    """Yield named conditions at the points, the simplest first."""
    zero = w == 0
    yield "ω = 0", zero.all(axis=1)
    for a in range(3):
        yield f"{SPIN[a]} = 0", zero[:, a]
        yield f"{SPIN[a]} ≠ 0", ~zero[:, a]
        yield f"{SPIN[a]} > 0", w[:, a] > 0
        yield f"{SPIN[a]} < 0", w[:, a] < 0
        yield f"{SPIN[a]} ≥ 0", w[:, a] >= 0
        yield f"{SPIN[a]} ≤ 0", w[:, a] <= 0
    for a, b in itertools.combinations(range(3), 2):
        difference = moments[:, b] - moments[:, a]
        yield f"{MOMENT[a]} = {MOMENT[b]}", difference == 0
        yield f"{MOMENT[a]} ≠ {MOMENT[b]}", difference != 0
        yield f"{MOMENT[a]} < {MOMENT[b]}", difference > 0
        yield f"{MOMENT[a]} > {MOMENT[b]}", difference < 0
        yield f"{MOMENT[a]} ≤ {MOMENT[b]}", difference >= 0
        yield f"{MOMENT[a]} ≥ {MOMENT[b]}", difference <= 0
    rank = np.argsort(np.argsort(moments, axis=1), axis=1)
    for a, place in itertools.product(range(3), range(3)):
        yield f"{MOMENT[a]} is the {PLACE[place]} moment", rank[:, a] == place
        yield f"{MOMENT[a]} is not the {PLACE[place]} moment", rank[:, a] != place
    for order in itertools.permutations(range(3)):
        steps = np.diff(moments[:, list(order)], axis=1)
        yield " < ".join(MOMENT[a] for a in order), np.all(steps > 0, axis=1)
        yield " ≤ ".join(MOMENT[a] for a in order), np.all(steps >= 0, axis=1)
        yield "not " + " < ".join(MOMENT[a] for a in order), ~np.all(steps > 0, axis=1)
    for a, b in itertools.combinations(range(3), 2):
        yield f"{SPIN[a]}{SPIN[b]} > 0", w[:, a] * w[:, b] > 0
        yield f"{SPIN[a]}{SPIN[b]} < 0", w[:, a] * w[:, b] < 0
        yield f"{SPIN[a]}{SPIN[b]} = 0", zero[:, a] | zero[:, b]
        yield f"{SPIN[a]}{SPIN[b]} ≠ 0", ~zero[:, a] & ~zero[:, b]
    yield "all ω are positive", np.all(w > 0, axis=1)
    yield "not all ω are positive", ~np.all(w > 0, axis=1)
    yield "a component of ω is zero", zero.any(axis=1)
    yield "no component of ω is zero", ~zero.any(axis=1)
    yield "ω lies along an axis", zero.sum(axis=1) >= 2
    equal = np.diff(np.sort(moments, axis=1), axis=1) == 0
    yield "two moments are equal", equal.any(axis=1)
    yield "the moments are all different", ~equal.any(axis=1)
    yield "all three moments are equal", equal.all(axis=1)
    rates = reference.euler_rhs(w.T, moments.T).T
    for a in range(3):
        yield f"{COMPONENT[a]} should be positive", rates[:, a] > 0
        yield f"{COMPONENT[a]} should be negative", rates[:, a] < 0


def _sizes(w: Array, moments: Array) -> Iterator[tuple[str, Array]]:
    """Yield named sizes that a threshold may cut."""
    yield "|ω|", np.linalg.norm(w, axis=1)
    for a in range(3):
        yield f"|{SPIN[a]}|", np.abs(w[:, a])
    yield "the smallest |ω| other than 0", np.where(w == 0, np.inf, np.abs(w)).min(axis=1)
    for a, b in itertools.combinations(range(3), 2):
        yield f"the smaller of |{SPIN[a]}| and |{SPIN[b]}|", np.abs(w[:, [a, b]]).min(axis=1)
    for a in range(3):
        yield MOMENT[a], moments[:, a]
    for a, b in itertools.combinations(range(3), 2):
        yield f"|{MOMENT[a]} − {MOMENT[b]}|", np.abs(moments[:, a] - moments[:, b])
    yield "the smallest difference of two moments", np.diff(np.sort(moments, axis=1), axis=1).min(axis=1)


def _threshold(name: str, size: Array, inside: Mask, outside: Mask) -> str | None:
    if size[inside].max() < size[outside].min():
        return f"{name} ≤ {size[inside].max():.3g}"
    if size[inside].min() > size[outside].max():
        return f"{name} ≥ {size[inside].min():.3g}"
    return None
