"""One component of a student's ω̇ read as algebra: its product of ω, its weights of the moments, its divisor
and extra terms.

Every component that is wrong by its indices, signs and factors has the form

    (α₁ I₁ + α₂ I₂ + α₃ I₃ + α₀) · ωₐ ω_b / D,

so one linear fit for each product and divisor finds it, whatever the errors and however many. Extra terms
are further columns of such a fit.
"""

import itertools
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from exercises.rigid_body.causes.fit import sums
from exercises.rigid_body.probes import scale
from exercises.rigid_body.public.diagnosis import (
    AGREEMENT,
    BACKWARDS,
    COMPONENT,
    ROUNDING,
    TORQUE,
    cause,
    multiple,
)
from exercises.rigid_body.public.quantities import Array
from polhode.judging.outcome import Diagnosis

Order = tuple[int, ...]
Form = tuple[tuple[Order, str, Order], list[float]]
"""A fitted component: the ω of its product, the text and the moments of its divisor; its weights of the three
moments and of 1.
"""

SPIN, MOMENT = ("ω₁", "ω₂", "ω₃"), ("I₁", "I₂", "I₃")
MOMENTS, SPINS = (
    ("{ii}", "{ij}", "{ik}"),
    ("{wi}", "{wj}", "{wk}"),
)  # as seen from a component, in the fields of Slip.text
ORDINARY = (1e-2, 1e2)  # sizes of |ω| and I to which forms are fitted; they are confirmed at all points
PRODUCTS = [*itertools.combinations_with_replacement(range(3), 2), (0,), (1,), (2,), ()]
DIVISORS = {
    "": 0,
    "{}": 1,
    "{}·{}": 2,
    "{}²": 1,
    "1/{}": 1,
    "({} + {})": 2,
    "(I₁ + I₂ + I₃)": 3,
    "|I|": 3,
}  # of so many moments
SAME = (0, 1, 2)


class Slip(NamedTuple):
    """One error of a component. ``text`` is the same for the same error in another component: its fields c,
    d, ii, ij, ik, wi, wj and wk are symbols as seen from the component. ``in_all`` says the same of all three
    components.
    """

    code: str
    text: str
    in_all: tuple["Slip", ...] = ()


SIGN = Slip("sign-flipped", "{c} has the opposite sign: check {d}", (Slip(*BACKWARDS),))
UNDIVIDED = Slip("missing-division", "{c} is not divided by {ik}", (Slip(*TORQUE),))
ZERO = Slip(
    "missing-component", "{c} is always zero", (Slip("missing-component", "euler_eqs returns zeros"),)
)
SUM_OF_ALL = Slip("moment-sum", "every component has the sum of two moments instead of their difference")
SUM = Slip("moment-sum", "{c} has the sum of two moments instead of their difference {d}", (SUM_OF_ALL,))


def forms(w: Array, moments: Array, wdot: Array, agreement: float = AGREEMENT) -> list[list[Form | None]]:
    """Return every form of each component of ``wdot`` (n, 3) at ω and I (n, 3); only None for a column of
    zeros.

    None of them has a factor that cancels, as in 3 I₁/I₁: that is another form.
    """
    divisors = [
        (text, axes) for text, number in DIVISORS.items() for axes in itertools.combinations(range(3), number)
    ]
    coefficients = np.array(
        [[*moments.T, np.ones(len(w))] / _divisor(text, moments[:, axes]) for text, axes in divisors]
    )
    products = np.array([w[:, product].prod(axis=1) for product in PRODUCTS])
    designs = (products[:, None, None] * coefficients).reshape(-1, 4, len(w)).swapaxes(1, 2)
    labels = [(product, *divisor) for product, divisor in itertools.product(PRODUCTS, divisors)]
    terms = dict(zip(labels, designs, strict=True))
    found = sums(terms, wdot, _size(w, moments), _slack(w, moments), agreement)
    return [
        [form for form in each if not _cancels(form)] if column.any() else [None]
        for column, each in zip(wdot.T, found, strict=True)
    ]


def _size(w: Array, moments: Array) -> Array:
    low, high = ORDINARY
    speed = np.linalg.norm(w, axis=1)
    ordinary = (speed > low) & (speed < high) & np.all((moments > low) & (moments < high) & (w != 0), axis=1)
    return np.where(ordinary, speed**2, np.inf)


def _slack(w: Array, moments: Array) -> Array:
    return np.asarray(ROUNDING * scale(w, moments).max(axis=1))


def _divisor(text: str, moments: Array) -> Array:
    if "+" in text:
        return np.asarray(moments.sum(axis=1))
    if text == "|I|":
        return np.asarray(np.linalg.norm(moments, axis=1))
    return np.asarray(moments.prod(axis=1) ** {"{}²": 2.0, "1/{}": -1.0}.get(text, 1.0))


def _cancels(form: Form) -> bool:
    (_, text, axes), weights = form
    used = [a for a, weight in enumerate(weights) if weight]
    return len(used) == 1 and (text == "1/{}" if used == [3] else text.startswith("{}") and used[0] in axes)


def readings(found: Iterable[Form | None], k: int, order: Order = SAME) -> list[list[Slip]]:
    """Return the errors of each form that can be read as component ``k`` (None: zero). The author took I
    number order[a] for I number a.
    """
    return [slips for form in found if (slips := _read(form, k, order)) is not None]


def _read(form: Form | None, k: int, order: Order) -> list[Slip] | None:
    if form is None:
        return [ZERO]
    (product, text, axes), weights = form
    divisor = text.format(*(MOMENTS[p] for p in sorted((order.index(a) - k - 1) % 3 for a in axes)))
    weighed = _weights([weights[order[(p + k + 1) % 3]] for p in range(3)], weights[3], divisor)
    return None if weighed is None else [*_product(sorted((a - k - 1) % 3 for a in product)), *weighed]


def scaled(factor: float) -> list[Slip]:
    """Return the error in a component that is the right value times ``factor``."""
    if factor == 1:
        return []
    return [SIGN if factor == -1 else Slip(*multiple("{c}", factor))]


def _product(places: list[int]) -> list[Slip]:
    has = [SPINS[p] for p in places]
    if places == [0, 1]:
        return []
    if len(places) < 2:
        return [
            Slip(
                "missing-term",
                f"{{c}} has {''.join(has) or 'no ω at all'} instead of the product {{wi}}·{{wj}}",
            )
        ]
    sentence = (
        f"{{c}} has the product {'·'.join(has)} instead of {{wi}}·{{wj}}: check the cyclic order of the"
        " indices"
    )
    return [Slip("cyclic-order", sentence)]


def _weights(weights: list[float], constant: float, divisor: str) -> list[Slip] | None:
    used, divided = [p for p in range(3) if weights[p]], _divided(divisor)
    if len(used) == 3 or (constant and used):
        return None
    if constant and divisor == "{ik}":
        return [
            Slip(
                "hard-coded-moments",
                f"{{c}} has the constant {constant:.10g} instead of the difference {{d}}",
            )
        ]
    if constant:
        sentence = f"{{c}} does not use the moments it is given: its coefficient is always {constant:.10g}"
        return [Slip("hard-coded-moments", sentence), *(divided if divisor else [])]
    if len(used) == 1:
        return [
            Slip("missing-term", f"{{c}} has {MOMENTS[used[0]]} alone instead of the difference {{d}}"),
            *divided,
        ]
    return _other_pair(weights, used, divided) if 2 in used else _pair(weights[0], weights[1], divided)


def _pair(first: float, second: float, divided: list[Slip]) -> list[Slip]:
    if first == -second and abs(first) != 1 and divided[:1] == [UNDIVIDED]:
        sentence = f"{{c}} is divided by the constant {1 / first:.10g} instead of {{ik}}"
        return [Slip("hard-coded-moments", sentence, in_all=(*UNDIVIDED.in_all, *scaled(first)))]
    if first == -second:
        return [*scaled(first), *divided]
    if first == second:
        return [SUM, *scaled(first), *divided]
    are = f"{first:.10g} for {{ii}} and {second:.10g} for {{ij}}"
    return [Slip("constant-factor", f"{{c}} has the factors {are} instead of 1 and −1"), *divided]


def _other_pair(weights: list[float], used: list[int], divided: list[Slip]) -> list[Slip] | None:
    a, b = sorted(used, key=lambda p: -weights[p])
    if abs(weights[a]) != abs(weights[b]):
        return None
    sign, summed = "−", list[Slip]()
    if weights[a] == weights[b]:
        sign, summed = "+", [Slip("moment-sum", "{c} has a sum of two moments instead of a difference")]
    sentence = f"{{c}} has ({MOMENTS[a]} {sign} {MOMENTS[b]}) instead of {{d}}: check the cyclic order"
    return [Slip("cyclic-order", sentence), *divided, *summed, *scaled(abs(weights[a]))]


def _divided(divisor: str) -> list[Slip]:
    if divisor == "{ik}":
        return []
    if not divisor:
        return [UNDIVIDED]
    did, due = (
        (f"multiplied by {divisor[2:]}", "divided by {ik}")
        if divisor[:2] == "1/"
        else (f"divided by {divisor}", "{ik}")
    )
    return [Slip("wrong-divisor", f"{{c}} is {did} instead of {due}")]


def extra_terms(column: Array, k: int, w: Array, moments: Array) -> list[list[Slip]]:
    """Return the errors if ``column`` (n,) is the right component ``k``, or a multiple of it, plus one or two
    known terms: damping, drag, torques and constants.
    """
    i, j = (k + 1) % 3, (k + 2) % 3
    wk, ik, speed = w[:, k], moments[:, k], np.linalg.norm(w, axis=1)
    drag = {"{wk}": wk, "|ω|{wk}": speed * wk, "|{wk}|{wk}": np.abs(wk) * wk, "": np.ones_like(wk)}
    powers = {"{wk}³": wk**3, "{wk}²": wk**2, "{wi}": w[:, i], "{wj}": w[:, j]}
    terms = drag | {f"{name}/{{ik}}": values / ik for name, values in drag.items()} | powers
    right = [moments[:, a] * w[:, i] * w[:, j] / ik for a in (i, j)]
    designs = {
        (a, b): np.column_stack([*right, terms[a], terms[b]]) for a, b in itertools.combinations(terms, 2)
    }
    found = []
    for names, (first, second, *sizes) in sums(
        designs, column[:, None], _size(w, moments), _slack(w, moments)
    )[0]:
        added = [f"{size:+.6g} {name}".rstrip() for name, size in zip(names, sizes, strict=True) if size]
        extra = [
            Slip("extra-term", f"{{c}} has an extra term {term}: torque-free equations have none")
            for term in added
        ]
        own = scaled(first) if first else [Slip("missing-component", "{c} lacks its own term")]
        found += [own + extra] if first == -second else []
    return found


def diagnoses(slips: Sequence[tuple[int, Slip]], *, in_place: bool = True) -> list[Diagnosis]:
    """Return the diagnoses of these errors of components. The same error in all three is one diagnosis.

    The components are ``in_place`` unless they are returned in the wrong order.
    """
    given = [slip for _, slip in slips]
    errors = [
        (k, each)
        for k, slip in slips
        for each in (slip.in_all if slip.in_all and given.count(slip) == 3 else [slip])
    ]
    found = {}
    for k, slip in errors:
        alike = [said(slip, other) for other, same in errors if same == slip]
        in_all = len(set(alike)) == 3
        sentence = f"{alike[0]}; likewise in the other two components" if in_all else said(slip, k)
        is_one = in_place and not in_all and "{c}" in slip.text
        found[sentence] = cause(slip.code, sentence, component=k if is_one else None)
    return list(found.values())


def said(slip: Slip, k: int) -> str:
    """Return the sentence of an error of component ``k``."""
    i, j = (k + 1) % 3, (k + 2) % 3
    spins = {"wi": SPIN[i], "wj": SPIN[j], "wk": SPIN[k]}
    return slip.text.format(
        c=COMPONENT[k], d=f"({MOMENT[i]} − {MOMENT[j]})", ii=MOMENT[i], ij=MOMENT[j], ik=MOMENT[k], **spins
    )
