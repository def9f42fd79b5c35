"""Functions that are right at some points only: where, as a condition on ω and I, and what is wrong
elsewhere.
"""

import itertools
from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

import reference
from exercises.rigid_body.causes.algebra import MOMENT, SPIN, Slip, diagnoses, forms, readings
from exercises.rigid_body.probes import scale
from exercises.rigid_body.public.diagnosis import COMPONENT, agree, cause
from exercises.rigid_body.public.quantities import Array
from polhode.judging.outcome import Diagnosis

Mask = NDArray[np.bool_]
LEAST_POINTS = 3  # that are right, and on each side of a threshold
PAIRS = list(itertools.combinations(range(3), 2))
SENSES = {
    "=": np.equal,
    "≠": np.not_equal,
    ">": np.greater,
    "<": np.less,
    "≥": np.greater_equal,
    "≤": np.less_equal,
}


def partly_right(w: Array, moments: Array, wdot: Array) -> list[Diagnosis]:
    """Return where each partly right component is right and what is wrong elsewhere; else which components
    are always right.
    """
    exact = reference.euler_rhs(w.T, moments.T).T
    right = agree(wdot, exact, scale(w, moments))
    wrong = [k for k in range(3) if not right[:, k].all()]
    good, bad = right & (exact != 0), ~right  # zero may be right by chance
    together = described(
        good[:, wrong].all(axis=1), np.asarray(bad.any(axis=1)), w, moments, least=LEAST_POINTS
    )
    where = {k: together or described(good[:, k], bad[:, k], w, moments, least=LEAST_POINTS) for k in wrong}
    if all(where.values()):
        parts = {place: [k for k in wrong if where[k] == place] for place in where.values()}
        slips = [(k, slip) for k in wrong for slip in _slips(k, bad[:, k], w, moments, wdot[:, k])]
        elsewhere = [cause(each.code, f"elsewhere {each.sentence}") for each in diagnoses(slips)]
        return [
            *(
                cause("partly-right", f"{_are(each)} right only where {place}")
                for place, each in parts.items()
            ),
            *elsewhere,
        ]
    if len(wrong) == 3:
        return []
    always, only = _are([k for k in range(3) if k not in wrong]), " and ".join(COMPONENT[k] for k in wrong)
    return [cause("partly-right", f"{always} right at every point; look at {only} only")]


def described(inside: Mask, outside: Mask, w: Array, moments: Array, least: int = 1) -> str | None:
    """Return in words what holds at all points ``inside`` (n,), ``least`` of them or more, and at none
    ``outside``; otherwise None.

    Of several thresholds that hold, the first two are named.
    """
    if inside.sum() < least or not outside.any():
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
    rates, sizes = reference.euler_rhs(w.T, moments.T), _sizes(w, moments)
    yield from _signs({"ω": sizes["|ω|"], **{SPIN[a]: w[:, a] for a in range(3)}})
    for a, b in PAIRS:
        yield from _signs({MOMENT[a]: moments[:, a] - moments[:, b]}, MOMENT[b])
    rank = np.argsort(np.argsort(moments, axis=1), axis=1)
    for a, (rank_, place) in itertools.product(range(3), enumerate(("smallest", "middle", "largest"))):
        yield f"{MOMENT[a]} is the {place} moment", rank[:, a] == rank_
        yield f"{MOMENT[a]} is not the {place} moment", rank[:, a] != rank_
    for order in itertools.permutations(range(3)):
        steps = np.diff(moments[:, order], axis=1).min(axis=1)
        yield " < ".join(MOMENT[a] for a in order), steps > 0
        yield " ≤ ".join(MOMENT[a] for a in order), steps >= 0
        yield "not " + " < ".join(MOMENT[a] for a in order), steps <= 0
    yield from _signs({f"{SPIN[a]}{SPIN[b]}": w[:, a] * w[:, b] for a, b in PAIRS})
    yield from _signs({"the smallest of all ω": w.min(axis=1), "ω₁ω₂ω₃": w.prod(axis=1)})
    yield from _signs({name: size for name, size in sizes.items() if "difference" in name})
    yield from _signs({f"the right {COMPONENT[a]}": rates[a] for a in range(3)})


def _signs(values: Mapping[str, Array], other: str = "0") -> Iterator[tuple[str, Mask]]:
    for (name, each), (sense, holds) in itertools.product(values.items(), SENSES.items()):
        yield f"{name} {sense} {other}", holds(each, 0)


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


def _slips(k: int, bad: Mask, w: Array, moments: Array, column: Array) -> list[Slip]:
    """Return the errors of component ``k`` at the points ``bad`` (n,), if the shortest readings agree."""
    found = readings(forms(w[bad], moments[bad], column[bad, None])[0], k)
    shortest = [slips for slips in found if len(slips) == min(map(len, found))]
    return shortest[0] if shortest and all(slips == shortest[0] for slips in shortest) else []


def _are(components: list[int]) -> str:
    if len(components) == 3:
        return "euler_eqs is"
    return " and ".join(COMPONENT[k] for k in components) + (" is" if len(components) == 1 else " are")
