"""The likely cause behind wrong rates: the fewest errors that reproduce every number to rounding, if they are
unique.
"""

import itertools
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

import reference
from ecp.outcome import Diagnosis
from exercises.assignment import Inputs
from exercises.rigid_body.causes.agreement import Mask, agree, same
from exercises.rigid_body.causes.errors import COMPONENT, MOMENT, Slip, diagnoses_of, read, slips
from exercises.rigid_body.causes.extra import extra_terms
from exercises.rigid_body.causes.hard_coded import same_body
from exercises.rigid_body.causes.partly import nearly_right, partly_right
from exercises.rigid_body.causes.precision import SINGLE, digits_kept, in_single, lost, precision_lost
from exercises.rigid_body.causes.sectors import described
from exercises.rigid_body.causes.table import readings, table
from exercises.rigid_body.causes.term_fit import LEAST_POINTS, Form, Points, relabelled

Array = NDArray[np.float64]
Order = tuple[int, int, int]
ORDERS: tuple[Order, ...] = ((0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0))
SAME: Order = (0, 1, 2)
MOST_SLIPS = 4


def causes_of_rates(inputs: Inputs, wdot: Array) -> list[Diagnosis]:
    """Return diagnoses for the rates (n, 3) in rad/s² at the probes ``inputs``; none if they are right or
    nothing singles one out.
    """
    t, w, moments = (np.asarray(inputs[name], dtype=float) for name in ("t", "w", "I"))
    finite: Mask = np.asarray(np.all(np.isfinite(wdot), axis=1))
    if np.all(finite):
        return _finite(t, w, moments, wdot)
    if found := _something_else(w, moments, wdot):
        return found
    rest = _finite(t[finite], w[finite], moments[finite], wdot[finite]) if finite.sum() > LEAST_POINTS else []
    return [*(cause for cause in rest if cause.code != "partly-right"), _not_finite(w, moments, finite)]


def _not_finite(w: Array, moments: Array, finite: Mask) -> Diagnosis:
    at = int(np.argmin(finite))
    place = described(~finite, finite, w, moments)
    if place is None and finite.any():
        spin, body = (", ".join(f"{x:.4g}" for x in numbers[at]) for numbers in (w, moments))
        place = f"ω = ({spin}) and I = ({body}), for example"
    where = f" where {place}" if place else ""
    return _cause("not-finite", f"euler_eqs returns values that are not finite{where}: look for a division by zero or an overflow")


def _finite(t: Array, w: Array, moments: Array, wdot: Array) -> list[Diagnosis]:
    if same(wdot, reference.euler_rhs(w.T, moments.T).T, w, moments):
        return precision_lost(wdot, w, moments)
    if _depends_on_time(t, w, moments, wdot):
        return [_cause("time-dependent", "euler_eqs depends on t: torque-free equations do not depend on time")]
    return _something_else(w, moments, wdot) or _slips(t, w, moments, wdot)


def _slips(t: Array, w: Array, moments: Array, wdot: Array) -> list[Diagnosis]:
    points = Points(w, moments)
    columns = [points.forms(column) for column in wdot.T]
    if all(columns):
        return _fewest(columns) or []
    if found := precision_lost(wdot, w, moments):
        return found
    for sentence, sorted_moments in _sorted(moments):
        again = [Points(w, sorted_moments).forms(column) for column in wdot.T]
        if all(again) and (slips_left := _fewest(again)) is not None:
            return [_cause("moment-order", sentence), *slips_left]
    found = _of_the_table(w, moments, wdot, columns) or extra_terms(wdot, t, w, moments, columns)
    found = found or _in_single(points, wdot) or digits_kept(wdot, w, moments)
    return found or partly_right(w, moments, wdot) or nearly_right(w, moments, wdot)


def _of_the_table(w: Array, moments: Array, wdot: Array, columns: list[list[Form | None]]) -> list[Diagnosis]:
    """Return diagnoses if each component without a form is a mistake of the table."""
    mistakes, chosen = table(w, moments, wdot), list[Slip]()
    for k, forms in enumerate(columns):
        found = read(forms, k) or readings(mistakes, wdot[:, k], w, moments, k)
        if not found or (not forms and len({slip[0].code for slip in found}) > 1):
            return []
        shortest: list[Slip] = min(found, key=len)
        chosen += shortest
    return diagnoses_of(chosen)


def _in_single(points: Points, wdot: Array) -> list[Diagnosis]:
    """Return the errors of an answer in single precision, which agrees to six digits only."""
    roughly = [points.forms(column, SINGLE) for column in wdot.T] if in_single(wdot) else [[]]
    return [*(_fewest(roughly) or []), lost("the answer is in single precision (float32)")] if all(roughly) else []


def _something_else(w: Array, moments: Array, wdot: Array) -> list[Diagnosis]:
    if not wdot.any():
        return [_cause("returns-zero", "euler_eqs returns zeros for all arguments")]
    for code, sentence, answer in _whole(w, moments):
        if same(wdot, answer, w, moments):
            return [_cause(code, sentence)]
        if same(wdot, -answer, w, moments):
            return [_cause(code, sentence), _cause("sign-reversed", "all three components have the opposite sign")]
    return []


def _whole(w: Array, moments: Array) -> Iterator[tuple[str, str, Array]]:
    momentum = moments * w
    for name, answer in (("ω", w), ("I", moments), ("L = Iω", momentum)):
        yield "returns-input", f"euler_eqs returns {name} itself instead of the rate of change of ω", answer
    swapped = reference.euler_rhs(moments.T, w.T).T
    yield "swapped-arguments", "w and I are swapped: the order is euler_eqs(t, w, I)", swapped


def _sorted(moments: Array) -> Iterator[tuple[str, Array]]:
    ascending = np.sort(moments, axis=1)
    yield "the moments are sorted: use I₁, I₂, I₃ in the given order", ascending
    yield "the moments are sorted, the largest first: use I₁, I₂, I₃ in the given order", ascending[:, ::-1]


def _fewest(columns: list[list[Form | None]]) -> list[Diagnosis] | None:
    """Return the explanation with the fewest errors, then the fewest swapped axes.

    Empty if two explanations with different codes are equally short; None if there is none.
    """
    best: list[tuple[tuple[int, int], list[Diagnosis]]] = []
    for outputs, order in itertools.product(ORDERS, ORDERS):
        chosen: list[Slip] = []
        for place, forms in enumerate(columns):
            readings = [slips(None if f is None else relabelled(f, order), outputs[place]) for f in forms]
            if not (readable := [r for r in readings if r is not None]):
                break
            plainest: list[Slip] = min(readable, key=len)
            chosen += plainest
        else:
            exchanged = (outputs != SAME) + (order != SAME)
            found = [*_exchanged(outputs, order), *(same_body(chosen) or diagnoses_of(_one_divisor(chosen)))]
            best.append(((len(found), exchanged), found))
    if not best:
        return None
    least = min(cost for cost, _ in best)
    if least[0] > MOST_SLIPS:
        return []
    shortest = [found for cost, found in best if cost == least]
    codes = {tuple(sorted(d.code for d in found)) for found in shortest}
    return shortest[0] if len(codes) == 1 else []


def _exchanged(outputs: Order, order: Order) -> Iterator[Diagnosis]:
    if outputs != SAME:
        stands = ", ".join(COMPONENT[k] for k in outputs)
        yield _cause("component-order", f"the components are returned in the wrong order: {stands}")
    if order != SAME:
        used = ", ".join(MOMENT[k] for k in order)
        yield _cause("moment-order", f"the moments are used in the order {used}: use them in the given order")


def _one_divisor(chosen: list[Slip]) -> list[Slip]:
    """Read three components divided by the same constant as not divided, and multiplied by its inverse."""
    constant = [s for s in chosen if s.kind == "divisor"]
    if len(constant) < 3 or len({s.value for s in constant}) > 1:
        return chosen
    kept = [s for s in chosen if s.kind != "divisor"]
    for s in constant:
        kept.append(Slip("missing-division", "no division", 0.0, s.component, ""))
        kept.append(Slip("constant-factor", "factor", s.value, s.component, ""))
    return kept


def _depends_on_time(t: Array, w: Array, moments: Array, wdot: Array) -> bool:
    """Return whether one (ω, I) got two answers at two times, but the same one at the same time."""
    _, first, which = np.unique(np.column_stack([w, moments]), axis=0, return_index=True, return_inverse=True)
    first = first[which.ravel()]
    apart, later = ~agree(wdot, wdot[first], w, moments).all(axis=1), t != t[first]
    return bool(np.any(apart & later) and not np.any(apart & ~later))


def _cause(code: str, sentence: str) -> Diagnosis:
    return Diagnosis(code=code, sentence=sentence, confidence=1.0)
