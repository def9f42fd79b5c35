"""The errors in a fitted form: each a diagnosis code and a sentence that says where to look."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from ecp.outcome import Diagnosis
from exercises.rigid_body.causes.term_fit import NORM, OTHERS, TOTAL, Form

COMPONENT = ("ω̇₁", "ω̇₂", "ω̇₃")
SPIN = ("ω₁", "ω₂", "ω₃")
MOMENT = ("I₁", "I₂", "I₃")
DIFFERENCE = ("(I₂ − I₃)", "(I₃ − I₁)", "(I₁ − I₂)")
DEGREE, RPM = np.pi / 180, 2 * np.pi / 60
ROUNDED = 2e-4  # relative: what 57.3 or 3.14 for π is off by at most, or nearly so
UNITS = (
    (1 / DEGREE, "180/π = 57.2958 converts radians into degrees"),
    (DEGREE, "π/180 converts degrees into radians"),
    (1 / DEGREE**2, "(180/π)², as if ω were in degrees per second"),
    (DEGREE**2, "(π/180)², as if ω were converted from degrees into radians"),
    (RPM, "2π/60 converts revolutions per minute (rpm) into rad/s"),
    (1 / RPM, "60/2π converts rad/s into revolutions per minute (rpm)"),
    (RPM**2, "(2π/60)², as if ω were converted from revolutions per minute (rpm) into rad/s"),
    (1 / RPM**2, "(60/2π)², as if ω were in revolutions per minute (rpm)"),
    (2 * np.pi, "2π converts revolutions into radians"),
    (1 / (2 * np.pi), "1/2π converts radians into revolutions"),
    (4 * np.pi**2, "(2π)², as if ω were converted from revolutions per second into rad/s"),
    (1 / (4 * np.pi**2), "1/(2π)², as if ω were in revolutions per second"),
)
ALL = {
    "sign": ("sign-reversed", "all three components have the opposite sign: the motion runs backwards in time"),
    "no division": ("missing-division", "no component is divided by its moment: the result is a torque, not ω̇"),
    "sum": ("moment-sum", "every component has the sum of two moments instead of their difference"),
    "zero": ("returns-zero", "euler_eqs returns zeros for all arguments"),
}


class Slip(NamedTuple):
    """One error in one component. ``kind`` and ``value`` are the same for the same error in another component."""

    code: str
    kind: str
    value: float
    component: int
    sentence: str


def slips(form: Form | None, k: int) -> list[Slip] | None:
    """Return the errors in a form that represents component ``k`` (None: zero), or None if it cannot be read
    as that component.
    """
    if form is None:
        return [Slip("missing-component", "zero", 0.0, k, f"{COMPONENT[k]} is always zero")]
    weighed = _weights(form, k)
    return None if weighed is None else [*_product(form, k), *weighed]


def read(forms: Iterable[Form | None], k: int) -> list[list[Slip]]:
    """Return the errors of each form that can be read as component ``k``."""
    return [found for form in forms if (found := slips(form, k)) is not None]


def diagnoses_of(found: Iterable[Slip]) -> list[Diagnosis]:
    """Return the diagnoses of these errors. The same error in all three components is one diagnosis."""
    slips_ = list(found)
    diagnoses: dict[str, Diagnosis] = {}
    for slip in slips_:
        same = [s for s in slips_ if (s.kind, s.value) == (slip.kind, slip.value)]
        code, sentence = slip.code, slip.sentence
        if len(same) == 3 and slip.kind in ALL:
            code, sentence = ALL[slip.kind]
        elif len(same) == 3:
            sentence = f"{same[0].sentence}; likewise in the other two components"
        diagnoses[sentence] = Diagnosis(code=code, sentence=sentence, confidence=1.0)
    return list(diagnoses.values())


def _product(form: Form, k: int) -> list[Slip]:
    i, j = (k + 1) % 3, (k + 2) % 3
    if sorted(form.product) == sorted((i, j)):
        return []
    if len(form.product) < 2:
        has = " and ".join(SPIN[a] for a in form.product) or "no ω at all"
        sentence = f"{COMPONENT[k]} has {has} instead of the product {SPIN[i]}·{SPIN[j]}"
        return [Slip("missing-term", f"product {_seen_from(k, form.product)}", 0.0, k, sentence)]
    is_, due = ("·".join(SPIN[a] for a in axes) for axes in (form.product, (i, j)))
    sentence = f"{COMPONENT[k]} has the product {is_} instead of {due}: check the cyclic order of the indices"
    return [Slip("cyclic-order", f"product {_seen_from(k, form.product)}", 0.0, k, sentence)]


def _weights(form: Form, k: int) -> list[Slip] | None:
    if form.constant is not None:
        return _hard_coded(form, k, form.constant)
    used = [a for a in range(3) if form.weights[a]]
    if len(used) == 1:
        sentence = f"{COMPONENT[k]} has {MOMENT[used[0]]} alone instead of the difference {DIFFERENCE[k]}"
        slip = Slip("missing-term", f"alone {(used[0] - k) % 3}", form.weights[used[0]], k, sentence)
        return [slip, *_divisor(form, k)]
    if len(used) == 2:
        return _other_difference(form, used, k) if k in used else _weighed_difference(form, k)
    return None


def _weighed_difference(form: Form, k: int) -> list[Slip]:
    i, j = (k + 1) % 3, (k + 2) % 3
    first, second = form.weights[i], form.weights[j]
    if first == -second and not form.divisor and abs(first) != 1:
        sentence = f"{COMPONENT[k]} is divided by the constant {1 / first:.10g} instead of {MOMENT[k]}"
        return [Slip("hard-coded-moments", "divisor", first, k, sentence)]
    if first == -second:
        return [*_scaled(first, k), *_divisor(form, k)]
    if first == second:
        sentence = f"{COMPONENT[k]} has the sum of two moments instead of their difference {DIFFERENCE[k]}"
        return [Slip("moment-sum", "sum", 0.0, k, sentence), *_scaled(first, k), *_divisor(form, k)]
    are = f"{first:.10g} for {MOMENT[i]} and {second:.10g} for {MOMENT[j]}"
    sentence = f"{COMPONENT[k]} has the factors {are} instead of 1 and −1"
    return [Slip("constant-factor", "weights", first, k, sentence), *_divisor(form, k)]


def _other_difference(form: Form, used: list[int], k: int) -> list[Slip] | None:
    a, b = used
    if abs(form.weights[a]) != abs(form.weights[b]):
        return None
    factor = abs(form.weights[a])
    sign = "−" if form.weights[a] != form.weights[b] else "+"
    if form.weights[a] < 0:
        a, b = b, a
    kind = f"difference {_offset(k, a)} {_offset(k, b)}"
    sentence = f"{COMPONENT[k]} has ({MOMENT[a]} {sign} {MOMENT[b]}) instead of {DIFFERENCE[k]}: check the cyclic order"
    found = [Slip("cyclic-order", kind, 0.0, k, sentence), *_divisor(form, k)]
    if sign == "+":
        found.append(Slip("moment-sum", "sum", 0.0, k, f"{COMPONENT[k]} has a sum of two moments instead of a difference"))
    return found if factor == 1 else [*found, *_scaled(factor, k)]


def _hard_coded(form: Form, k: int, value: float) -> list[Slip]:
    if form.divisor == (k,):
        sentence = f"{COMPONENT[k]} has the constant {value:.10g} instead of the difference {DIFFERENCE[k]}"
        return [Slip("hard-coded-moments", "difference", value, k, sentence)]
    sentence = f"{COMPONENT[k]} does not use the moments it is given: its coefficient is always {value:.10g}"
    return [Slip("hard-coded-moments", "coefficient", value, k, sentence), *(_divisor(form, k) if form.divisor else [])]


def _scaled(factor: float, k: int) -> list[Slip]:
    if factor == 1:
        return []
    if factor == -1:
        return [Slip("sign-flipped", "sign", 0.0, k, f"{COMPONENT[k]} has the opposite sign: check {DIFFERENCE[k]}")]
    for known, what in UNITS:
        if abs(abs(factor) / known - 1) < ROUNDED:
            sense = " and the opposite sign" if factor < 0 else ""
            sentence = f"{COMPONENT[k]} is {factor:.7g} times the right value: {what}{sense}; ω is in rad/s, ω̇ in rad/s²"
            return [Slip("units", "factor", factor, k, sentence)]
    sentence = f"{COMPONENT[k]} is {factor:.10g} times the right value: look for an extra factor"
    return [Slip("constant-factor", "factor", factor, k, sentence)]


def _divisor(form: Form, k: int) -> list[Slip]:
    if form.divisor == (k,):
        return []
    kind = f"divisor {_seen_from(k, form.divisor)}"
    if not form.divisor:
        return [Slip("missing-division", "no division", 0.0, k, f"{COMPONENT[k]} is not divided by {MOMENT[k]}")]
    if form.divisor[0] < 0:
        did, due = f"multiplied by {MOMENT[~form.divisor[0]]}", f"divided by {MOMENT[k]}"
    else:
        did, due = f"divided by {_named(form.divisor)}", MOMENT[k]
    return [Slip("wrong-divisor", kind, 0.0, k, f"{COMPONENT[k]} is {did} instead of {due}")]


def _named(divisor: tuple[int, ...]) -> str:
    if divisor[0] in (TOTAL, NORM):
        return "(I₁ + I₂ + I₃)" if divisor[0] == TOTAL else "|I|"
    if divisor[0] >= OTHERS:
        return "(" + " + ".join(m for a, m in enumerate(MOMENT) if a != divisor[0] - OTHERS) + ")"
    if len(divisor) == 2 and divisor[0] == divisor[1]:
        return f"{MOMENT[divisor[0]]}²"
    return "·".join(MOMENT[a] for a in divisor)


def _seen_from(k: int, axes: tuple[int, ...]) -> str:
    """Return axes counted from ``k``, so that the same error in the next component reads the same."""
    return " ".join(sorted(_offset(k, a) for a in axes))


def _offset(k: int, a: int) -> str:
    if a < 0:
        return f"*{(~a - k) % 3}"
    if a >= OTHERS:
        return "+" if a == TOTAL else "|" if a == NORM else f"+{(a - OTHERS - k) % 3}"
    return str((a - k) % 3)
