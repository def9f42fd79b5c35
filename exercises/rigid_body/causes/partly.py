"""Functions that are right at some points, or nearly right: where, and what is wrong elsewhere."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import reference
from ecp.outcome import Diagnosis
from exercises.rigid_body.causes.agreement import Mask, agree
from exercises.rigid_body.causes.errors import COMPONENT, Slip, diagnoses_of, read
from exercises.rigid_body.causes.sectors import described
from exercises.rigid_body.causes.term_fit import Points
from exercises.rigid_body.probes import scale

Array = NDArray[np.float64]
NEARLY = 0.01  # of the largest rate at each point
MOST = 0.9  # of the points
LEAST_POINTS = 3


class Part(NamedTuple):
    """Component ``k`` is right only where ``right``; elsewhere it has these ``slips``."""

    k: int
    right: str
    slips: list[Slip]


def partly_right(w: Array, moments: Array, wdot: Array) -> list[Diagnosis]:
    """Return where each partly right component is right and what is wrong elsewhere; else which components
    are always right.
    """
    exact = reference.euler_rhs(w.T, moments.T).T
    right = agree(wdot, exact, w, moments)
    wrong = [k for k in range(3) if not right[:, k].all()]
    good, bad = right & (exact != 0), ~right
    together = _place(np.all(good[:, wrong], axis=1), np.any(bad, axis=1), w, moments)
    parts = []
    for k in wrong:
        place = together or _place(good[:, k], bad[:, k], w, moments)
        parts.append(Part(k, place, _slips(k, bad[:, k], (w, moments, wdot[:, k]))) if place else None)
    known = [part for part in parts if part]
    if len(known) == len(wrong):
        return [*_places(known), *_elsewhere(known)]
    if len(wrong) == 3:
        return []
    always = " and ".join(COMPONENT[k] for k in range(3) if k not in wrong)
    only = " and ".join(COMPONENT[k] for k in wrong)
    return [_partly(f"{always} {'is' if len(wrong) == 2 else 'are'} right at every point; look at {only} only")]


def nearly_right(w: Array, moments: Array, wdot: Array) -> list[Diagnosis]:
    """Return the diagnosis if nearly all rates are within 1 % of the right ones but few are right."""
    exact = reference.euler_rhs(w.T, moments.T).T
    largest, size = np.abs(exact).max(axis=1), scale(w, moments).max(axis=1)
    off = np.abs(wdot - exact).max(axis=1) / np.where(largest > 0, largest, np.where(size > 0, size, 1.0))
    near, right = off <= NEARLY, agree(wdot, exact, w, moments).all(axis=1)
    if near.mean() < MOST or right.mean() > 1 - MOST / 2:
        return []
    where = "" if near.all() else f" at {near.sum()} of {len(w)} points"
    remedy = "compute the rates from Euler's equations, not by numerical differentiation or integration"
    sentence = f"nearly right: within {off[near].max():.2g} of the right values{where}: {remedy}"
    return [Diagnosis(code="nearly-right", sentence=sentence, confidence=0.8)]


def _place(good: Mask, bad: Mask, w: Array, moments: Array) -> str | None:
    """Return what holds at the points (n,) that are ``good``, right and not zero, and at none that is ``bad``."""
    return described(good, bad, w, moments) if good.sum() >= LEAST_POINTS else None


def _slips(k: int, bad: Mask, answers: tuple[Array, Array, Array]) -> list[Slip]:
    """Return the errors of component ``k`` at the points ``bad`` (n,), if the shortest readings agree."""
    w, moments, column = answers
    found = read(Points(w[bad], moments[bad]).forms(column[bad]), k)
    kinds = {tuple(slip.kind for slip in slips) for slips in found if len(slips) == min(map(len, found))}
    return min(found, key=len) if len(kinds) == 1 else []


def _places(parts: list[Part]) -> list[Diagnosis]:
    if len(parts) == 3 and len({part.right for part in parts}) == 1:
        return [_partly(f"euler_eqs is right only where {parts[0].right}")]
    places = dict.fromkeys(part.right for part in parts)
    named = {place: " and ".join(COMPONENT[part.k] for part in parts if part.right == place) for place in places}
    return [_partly(f"{which} {'are' if ' and ' in which else 'is'} right only where {place}") for place, which in named.items()]


def _elsewhere(parts: list[Part]) -> list[Diagnosis]:
    found = diagnoses_of(slip for part in parts for slip in part.slips)
    zeros = [Diagnosis(code="missing-component", sentence="elsewhere euler_eqs returns zeros", confidence=1.0)]
    if [cause.code for cause in found] == ["returns-zero"]:
        return zeros
    return [Diagnosis(code=cause.code, sentence=f"elsewhere {cause.sentence}", confidence=1.0) for cause in found]


def _partly(sentence: str) -> Diagnosis:
    return Diagnosis(code="partly-right", sentence=sentence, confidence=1.0)
