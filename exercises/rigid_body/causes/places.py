"""Functions that are right at some points only: where, as a condition on ω and I, and what is wrong elsewhere."""

import itertools
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

import reference
from ecp.outcome import Diagnosis
from exercises.rigid_body.causes.algebra import MOMENT, SPIN, Slip, diagnoses, forms, readings
from exercises.rigid_body.probes import scale
from exercises.rigid_body.public.diagnosis import COMPONENT, agree, cause

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
LEAST_POINTS = 3  # that are right, and on each side of a threshold
PAIRS = list(itertools.combinations(range(3), 2))
SENSES = {"=": np.equal, "≠": np.not_equal, ">": np.greater, "<": np.less, "≥": np.greater_equal, "≤": np.less_equal}
PLACE = ("smallest", "middle", "largest")


def partly_right(w: Array, moments: Array, wdot: Array) -> list[Diagnosis]:
    """Return where each partly right component is right and what is wrong elsewhere; else which components
    are always right.
    """
    exact = reference.euler_rhs(w.T, moments.T).T
    right = agree(wdot, exact, scale(w, moments))
    wrong = [k for k in range(3) if not right[:, k].all()]
    good = right & (exact != 0)
    together = _place(good[:, wrong].all(axis=1), np.asarray(~right.all(axis=1)), w, moments)
    places = {k: together or _place(good[:, k], ~right[:, k], w, moments) for k in wrong}
    if all(places.values()):
        slips = [(k, slip) for k in wrong for slip in _slips(k, ~right[:, k], w, moments, wdot[:, k])]
        return [*_right_only(places), *map(_elsewhere, diagnoses(slips))]
    if len(wrong) == 3:
        return []
    always, only = _subject([k for k in range(3) if k not in wrong]), " and ".join(COMPONENT[k] for k in wrong)
    return [cause("partly-right", f"{always} right at every point; look at {only} only")]


def described(inside: Mask, outside: Mask, w: Array, moments: Array) -> str | None:
    """Return in words what holds at all points ``inside`` (n,) and at none ``outside``, or None.

    Of several thresholds that hold, the first two are named.
    """
    if not inside.any() or not outside.any():
        return None
    for name, where in _conditions(w, moments):
        if np.all(where[inside]) and not np.any(where[outside]):
            return name
    if min(inside.sum(), outside.sum()) < LEAST_POINTS:
        return None
    found = []
    for name, size in _sizes(w, moments).items():
        if size[inside].max() < size[outside].min():
            found.append(f"{name} ≤ {size[inside].max():.3g}")
        elif size[inside].min() > size[outside].max():
            found.append(f"{name} ≥ {size[inside].min():.3g}")
    return " or ".join(found[:2]) or None


def _conditions(w: Array, moments: Array) -> Iterator[tuple[str, Mask]]:
    """Yield named conditions at the points (n,), the simplest first."""
    signs = [("ω", "0", np.linalg.norm(w, axis=1)), *((SPIN[a], "0", w[:, a]) for a in range(3))]
    signs += [(MOMENT[a], MOMENT[b], moments[:, a] - moments[:, b]) for a, b in PAIRS]
    for name, other, values in signs:
        for sign, holds in SENSES.items():
            yield f"{name} {sign} {other}", holds(values, 0)
    rank = np.argsort(np.argsort(moments, axis=1), axis=1)
    for a, place in itertools.product(range(3), range(3)):
        yield f"{MOMENT[a]} is the {PLACE[place]} moment", rank[:, a] == place
        yield f"{MOMENT[a]} is not the {PLACE[place]} moment", rank[:, a] != place
    for order in itertools.permutations(range(3)):
        steps = np.diff(moments[:, order], axis=1).min(axis=1)
        yield " < ".join(MOMENT[a] for a in order), steps > 0
        yield " ≤ ".join(MOMENT[a] for a in order), steps >= 0
        yield "not " + " < ".join(MOMENT[a] for a in order), steps <= 0
    rates, sizes = reference.euler_rhs(w.T, moments.T), _sizes(w, moments)
    gap, gaps = "the smallest difference of two moments", "the largest difference of two moments"
    signs = [(f"{SPIN[a]}{SPIN[b]}", "0", w[:, a] * w[:, b]) for a, b in PAIRS]
    signs += [("the smallest of all ω", "0", w.min(axis=1)), ("ω₁ω₂ω₃", "0", w.prod(axis=1))]
    signs += [(name, "0", sizes[name]) for name in (gap, gaps)] + [(f"the right {COMPONENT[a]}", "0", rates[a]) for a in range(3)]
    for name, other, values in signs:
        for sign, holds in SENSES.items():
            yield f"{name} {sign} {other}", holds(values, 0)


def _sizes(w: Array, moments: Array) -> dict[str, Array]:
    """Return named sizes (n,) that a threshold may cut."""
    gaps, spins = np.abs(moments - np.roll(moments, -1, axis=1)), np.abs(w)
    return {
        "|ω|": np.linalg.norm(w, axis=1),
        **{f"|{SPIN[a]}|": spins[:, a] for a in range(3)},
        "the smallest |ω| other than 0": np.where(w == 0, np.inf, spins).min(axis=1),
        **{f"the smaller of |{SPIN[a]}| and |{SPIN[b]}|": spins[:, [a, b]].min(axis=1) for a, b in PAIRS},
        **{MOMENT[a]: moments[:, a] for a in range(3)},
        **{f"|{MOMENT[a]} − {MOMENT[b]}|": np.abs(moments[:, a] - moments[:, b]) for a, b in PAIRS},
        "the smallest difference of two moments": gaps.min(axis=1),
        "the largest difference of two moments": gaps.max(axis=1),
    }


def _place(good: Mask, bad: Mask, w: Array, moments: Array) -> str | None:
    """Return what holds at the points (n,) that are ``good``, right and not zero, and at none that is ``bad``."""
    return described(good, bad, w, moments) if good.sum() >= LEAST_POINTS else None


def _slips(k: int, bad: Mask, w: Array, moments: Array, column: Array) -> list[Slip]:
    """Return the errors of component ``k`` at the points ``bad`` (n,), if the shortest readings agree."""
    found = readings(forms(w[bad], moments[bad], column[bad, None])[0], k)
    shortest = [slips for slips in found if len(slips) == min(map(len, found))]
    return shortest[0] if shortest and all(slips == shortest[0] for slips in shortest) else []


def _right_only(places: dict[int, str | None]) -> list[Diagnosis]:
    where = dict.fromkeys(places.values())
    of = {place: [k for k in places if places[k] == place] for place in where}
    return [cause("partly-right", f"{_subject(k)} right only where {place}") for place, k in of.items()]


def _subject(components: list[int]) -> str:
    if len(components) == 3:
        return "euler_eqs is"
    return " and ".join(COMPONENT[k] for k in components) + (" is" if len(components) == 1 else " are")


def _elsewhere(found: Diagnosis) -> Diagnosis:
    if found.code == "returns-zero":
        return cause("missing-component", "elsewhere euler_eqs returns zeros")
    return cause(found.code, f"elsewhere {found.sentence}")
