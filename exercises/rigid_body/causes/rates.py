"""The likely cause behind wrong rates: the fewest errors that reproduce every number to rounding, if they are
unique.
"""

import itertools
from collections.abc import Sequence

import numpy as np

from exercises.authoring.assignments.assignment import Inputs
from exercises.rigid_body.causes import formulas
from exercises.rigid_body.causes.algebra import (
    MOMENT,
    SAME,
    Form,
    Slip,
    diagnoses,
    extra_terms,
    forms,
    readings,
    scaled,
)
from exercises.rigid_body.causes.fit import LEAST_POINTS
from exercises.rigid_body.causes.places import described, partly_right
from exercises.rigid_body.probes import scale
from exercises.rigid_body.public.diagnosis import (
    ROUNDING,
    Mistake,
    agree,
    cause,
    known_rates,
    named,
    nearly_right,
    not_finite,
)
from exercises.rigid_body.public.quantities import Array
from polhode.judging.outcome import Diagnosis

ORDERS = list(itertools.permutations(range(3)))
MOST = 4  # errors of forms: more of them may reproduce any numbers of that kind
SINGLE = 1e-6  # agreement to expect in single precision


def causes_of_rates(inputs: Inputs, wdot: Array) -> list[Diagnosis]:
    """Return diagnoses for the rates (n, 3) in rad/s² at the probes ``inputs``; none if they are right or
    nothing singles one out.
    """
    t, w, moments = (np.asarray(inputs[name], dtype=float) for name in ("t", "w", "I"))
    finite = np.asarray(np.isfinite(wdot).all(axis=1))
    if finite.all():
        return _finite(t, w, moments, wdot)
    if found := _whole(w, moments, wdot):
        return found
    place = described(~finite, finite, w, moments)
    if place is None and finite.any():
        spin, body = (", ".join(f"{x:.4g}" for x in numbers[np.argmin(finite)]) for numbers in (w, moments))
        place = f"ω = ({spin}) and I = ({body}), for example"
    rest = _finite(t[finite], w[finite], moments[finite], wdot[finite]) if finite.sum() > LEAST_POINTS else []
    return [
        *(known for known in rest if known.code != "partly-right"),
        not_finite(f" where {place}" if place else ""),
    ]


def _whole(w: Array, moments: Array, wdot: Array) -> list[Diagnosis]:
    return known_rates(wdot, formulas.of_all_components(w, moments, wdot), scale(w, moments))


def _finite(t: Array, w: Array, moments: Array, wdot: Array) -> list[Diagnosis]:
    exact, size = formulas.exact(w, moments), scale(w, moments)
    if agree(wdot, exact, size).all():
        return []
    if found := _whole(w, moments, wdot) or _of_time(t, w, moments, wdot):
        return found
    explained = _explained(w, moments, wdot)
    if explained is None:
        return (
            _few_digits(w, moments, wdot) or partly_right(w, moments, wdot) or nearly_right(wdot, exact, size)
        )
    return explained


def _explained(w: Array, moments: Array, wdot: Array) -> list[Diagnosis] | None:
    """Return the fewest errors that reproduce the rates, none if they are not unique, or None if there are
    none.
    """
    columns, ascending = forms(w, moments, wdot), np.sort(moments, axis=1)
    if (found := _fewest(columns)) is not None:
        return found if len(found) <= MOST else []
    for largest_first, given in (("", ascending), (", the largest first", ascending[:, ::-1])):
        if (found := _fewest(forms(w, given, wdot))) is not None:
            return [
                cause(
                    "moment-order",
                    f"the moments are sorted{largest_first}: use I₁, I₂, I₃ in the given order",
                ),
                *found,
            ]
    mistakes = list(formulas.of_one_component(w, moments, wdot))
    others = [
        readings(columns[k], k)
        or _formulas(mistakes, k, w, moments, wdot)
        or extra_terms(wdot[:, k], k, w, moments)
        for k in range(3)
    ]
    return _fewest(columns, others)


def _few_digits(w: Array, moments: Array, wdot: Array) -> list[Diagnosis]:
    """Return the diagnosis of right rates with too few digits, or of wrong rates in single precision."""
    exact, single = formulas.exact(w, moments), np.array_equal(wdot, wdot.astype(np.float32))
    off = float(np.where(wdot == exact, 0.0, np.abs(wdot - exact) / scale(w, moments)).max())
    float32 = cause("precision-loss", formulas.too_few_digits("the answer is in single precision (float32)"))
    if single and (found := _fewest(forms(w, moments, wdot, SINGLE))) is not None:
        return [*found, float32]
    if not ROUNDING < off < SINGLE:
        return []
    return [cause("precision-loss", formulas.too_few_digits(f"only {int(-np.log10(off))} digits are right"))]


def _formulas(mistakes: list[Mistake], k: int, w: Array, moments: Array, wdot: Array) -> list[list[Slip]]:
    """Return the errors that reproduce component ``k``: a wrong formula, or its negative; none if two codes
    do.
    """
    found: dict[str, list[Slip]] = {}
    own, size = slice(k, k + 1), scale(w, moments)
    for (code, sentence, values), sign in itertools.product(mistakes, (1.0, -1.0)):
        if agree(wdot[:, own], sign * values[:, own], size[:, own]).all():
            found.setdefault(sentence, [Slip(code, sentence), *scaled(sign)])
    return list(found.values()) if len({slips[0].code for slips in found.values()}) == 1 else []


def _fewest(
    columns: list[list[Form | None]], others: list[list[list[Slip]]] | None = None
) -> list[Diagnosis] | None:
    """Return the explanation with the fewest errors, then the fewest swapped axes, by the forms of the
    components; in the right order also by ``others``, errors of any kind.

    Empty if two explanations with different codes are equally short; None if there is none.
    """
    found: dict[tuple[int, int], list[list[Diagnosis]]] = {}
    for outputs, order in itertools.product(ORDERS, ORDERS):
        found_slips = [readings(each, k, order) for each, k in zip(columns, outputs, strict=True)]
        if others and outputs == order == SAME:
            found_slips = others
        if all(found_slips):
            slips = [
                (k, slip) for k, each in zip(outputs, found_slips, strict=True) for slip in min(each, key=len)
            ]
            swapped = _swapped(outputs, order)
            explained = [*swapped, *diagnoses(slips, in_place=outputs == SAME)]
            found.setdefault((len(explained), len(swapped)), []).append(explained)
    if not found:
        return None
    shortest = found[min(found)]
    same = len({tuple(sorted(known.code for known in each)) for each in shortest}) == 1
    return shortest[0] if same else []


def _swapped(outputs: Sequence[int], order: Sequence[int]) -> list[Diagnosis]:
    found, used = [], ", ".join(MOMENT[k] for k in order)
    if outputs != SAME:
        found.append(
            cause("component-order", f"the components are returned in the wrong order: {named(outputs)}")
        )
    if order != SAME:
        found.append(
            cause("moment-order", f"the moments are used in the order {used}: use them in the given order")
        )
    return found


def _of_time(t: Array, w: Array, moments: Array, wdot: Array) -> list[Diagnosis]:
    """Return the diagnosis if one (ω, I) got two answers at two times, but the same one at the same time."""
    _, first, which = np.unique(np.column_stack([w, moments]), axis=0, return_index=True, return_inverse=True)
    first = first[which.ravel()]
    apart, later = ~agree(wdot, wdot[first], scale(w, moments)).all(axis=1), t != t[first]
    if not np.any(apart & later) or np.any(apart & ~later):
        return []
    return [cause("time-dependent", "euler_eqs depends on t: torque-free equations do not depend on time")]
