"""Wrong formulas that predict numbers, other than wrong indices, signs, factors and divisors (algebra.py):
missing brackets, absolute values, floor division, clipping, normalized or inverted arguments, powers and lost
digits.
"""

from collections.abc import Callable, Iterator

import numpy as np

import reference
from exercises.rigid_body.public.diagnosis import Mistake, answers
from exercises.rigid_body.public.quantities import BODY, SYMMETRIC, Array
from exercises.rigid_body.scenes import BOOK

COEFFICIENTS = 1e-9  # agreement of a body's three coefficients
LEAST_LIMIT = 1e-9  # of rates that were clipped, not lost
LIMITS = (1.0, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0, 100.0, 1000.0)  # to which ω may have been clipped


def _rounding(places: int) -> Callable[[Array], Array]:
    return lambda x: np.round(x, places)


BODIES = {"exercises 2 and 3": BODY, "exercises 4 and 6": SYMMETRIC, "the book": tuple(BOOK)}
CUTS: dict[str, Callable[[Array], Array]] = {
    "in half precision (float16)": lambda x: x.astype(np.float16).astype(float),
    "in single precision (float32)": lambda x: x.astype(np.float32).astype(float),
    "cut to whole numbers: look for an array of integers": np.trunc,
    "rounded to whole numbers": np.round,
    **{f"rounded to {places} decimal places": _rounding(places) for places in range(1, 13)},
}


def exact(w: Array, moments: Array) -> Array:
    """Return the right rates (n, 3) at ω and I (n, 3)."""
    return np.asarray(reference.euler_rhs(w.T, moments.T).T)


def of_all_components(w: Array, moments: Array, seen: Array) -> Iterator[Mistake]:
    """Yield mistakes with the values (n, 3) that they give to all components at ω and I (n, 3).

    The coefficients of a constant body are read from the ``seen`` rates.
    """
    right = exact(w, moments)
    yield from answers(w, moments, right)
    yield "swapped-arguments", "w and I are swapped: the order is euler_eqs(t, w, I)", exact(moments, w)
    for where, body in BODIES.items():
        sentence = f"euler_eqs always uses the moments of {where} and ignores its argument I"
        yield "hard-coded-moments", sentence, exact(w, np.broadcast_to(body, w.shape))
    products = np.roll(w, -1, 1) * np.roll(w, -2, 1)
    a, b, c = coefficients = (seen * products).sum(axis=0) / (products**2).sum(axis=0)
    if abs(a + b + c + a * b * c) <= COEFFICIENTS < np.abs(coefficients).max() and b != 1:
        ratio = f"1 : {(1 + a) / (1 - b):.6g} : {1 + b * (1 + a) / (1 - b):.6g}"
        sentence = f"euler_eqs always uses moments in the ratio {ratio} and ignores its argument I"
        yield "hard-coded-moments", sentence, coefficients * products
    for how, cut in CUTS.items():
        answers_ = {
            "ω and I are": exact(cut(w), cut(moments)),
            "ω is": exact(cut(w), moments),
            "I is": exact(w, cut(moments)),
        }
        for what, values in (answers_ | {"the answer is": cut(right)}).items():
            yield "precision-loss", too_few_digits(f"{what} {how}"), values


def too_few_digits(how: str) -> str:
    """Return the sentence for digits lost in this way."""
    return f"too few digits: {how}; keep everything in double precision"


def of_one_component(w: Array, moments: Array, seen: Array) -> Iterator[Mistake]:
    """Yield mistakes with the values (n, 3) that they give to each component at ω and I (n, 3).

    The limit of clipped rates is read from the ``seen`` ones. A sentence has the fields of
    ``algebra.Slip.text``.
    """
    for code, sentence, values in (*_terms(w, moments), *_cut(w, moments, seen)):
        yield code, f"{{c}} {sentence}", values


def _terms(w: Array, moments: Array) -> Iterator[Mistake]:
    ii, ij, wi, wj, ik, wk = (
        np.roll(moments, -1, 1),
        np.roll(moments, -2, 1),
        np.roll(w, -1, 1),
        np.roll(w, -2, 1),
        moments,
        w,
    )
    right, product = exact(w, moments), wi * wj
    speed, length = (np.linalg.norm(x, axis=1, keepdims=True) for x in (w, moments * w))
    speed, length = (np.where(x > 0, x, 1.0) for x in (speed, length))
    for text, values in (
        ("{ii} − {ij}·{wi}{wj}/{ik}", ii - ij * product / ik),
        ("{ii}·{wi}{wj} − {ij}·{wi}{wj}/{ik}", ii * product - ij * product / ik),
        ("({ii} − {ij}·{wi}{wj})/{ik}", (ii - ij * product) / ik),
        ("{ii} − {ij}·{wi}{wj}", ii - ij * product),
        ("({ii} − {ij}/{ik})·{wi}{wj}", (ii - ij / ik) * product),
        ("({ii} − {ij})/({ik}·{wi}{wj})", (ii - ij) / (ik * product)),
        ("({ii} − {ij})·{wi}/({ik}·{wj})", (ii - ij) * wi / (ik * wj)),
        ("({ii} − {ij})·{wj}/({ik}·{wi})", (ii - ij) * wj / (ik * wi)),
    ):
        yield (
            "missing-brackets",
            f"is computed as {text} instead of {{d}}·{{wi}}{{wj}}/{{ik}}: check the brackets",
            values,
        )
    for text, values in (
        ("the whole result", np.abs(right)),
        ("the difference {d}", np.abs(ii - ij) * product / ik),
        ("the product {wi}{wj}", (ii - ij) * np.abs(product) / ik),
        ("{wi}", (ii - ij) * np.abs(wi) * wj / ik),
        ("{wj}", (ii - ij) * wi * np.abs(wj) / ik),
    ):
        yield "absolute-value", f"takes the absolute value of {text}: its sign is lost", values
    for values in (np.floor(right), (ii - ij) // ik * product, (ii - ij) * wi // ik * wj):
        yield (
            "floor-division",
            "uses floor division (//), which drops the fraction: divide by {ik} with /",
            values,
        )
    yield "normalised", "is computed from the unit vector ω/|ω|: use ω itself", right / speed**2
    yield "normalised", "lacks a factor |ω|: one of its ω comes from the unit vector ω/|ω|", right / speed
    yield "normalised", "lacks a factor |L|: L comes from a unit vector", right / length
    smallest, middle, largest = np.sort(moments, axis=1).T[:, :, None]
    norm = np.linalg.norm(moments, axis=1, keepdims=True)
    for text, size in (
        ("|I|", norm),
        ("their sum", moments.sum(axis=1, keepdims=True)),
        ("the largest", largest),
    ):
        yield "normalised", f"has moments divided by {text} in one place and not in another", right / size
    for text, size in (("largest", largest), ("middle", middle), ("smallest", smallest)):
        yield "wrong-divisor", f"is divided by the {text} of the moments instead of {{ik}}", right * ik / size
    yield "inverted-moments", "has I and 1/I swapped: use {d}/{ik}", exact(w, 1 / moments)
    replaced = w.copy()
    for k in range(3):
        replaced[:, k] = exact(replaced, moments)[:, k]
    overwritten = "is computed from rates that already replaced ω: keep ω until all three are computed"
    yield "wrong-quantity", overwritten, replaced
    energy = (moments * w**2).sum(axis=1, keepdims=True)
    yield "wrong-quantity", "is multiplied by ω·L, twice the energy", right * energy
    for text, values in (
        ("has the squares {wi}² and {wj}² instead of {wi} and {wj}", right * product),
        ("has {wi}²{wj} instead of {wi}{wj}", right * wi),
        ("has {wi}{wj}² instead of {wi}{wj}", right * wj),
        ("has {ii}² − {ij}² instead of {d}", right * (ii + ij)),
        ("has {ii}² − {ij}² instead of {d}, and {ik}² instead of {ik}", right * (ii + ij) / ik),
        ("has {wi}{wj}{wk} instead of {wi}{wj}", right * wk),
        ("is the square of the right value, with its sign", right * np.abs(right)),
        ("is the square of the right value", right**2),
        ("is the square root of the right value, with its sign", np.sign(right) * np.sqrt(np.abs(right))),
        ("is multiplied by |ω|", right * speed),
    ):
        yield "wrong-power", text, values


def _cut(w: Array, moments: Array, seen: Array) -> Iterator[Mistake]:
    right, speed = exact(w, moments), np.linalg.norm(w, axis=1, keepdims=True)
    yield "clipped", "is never negative: negative values are cut to zero", np.maximum(right, 0.0)
    yield "clipped", "is never positive: positive values are cut to zero", np.minimum(right, 0.0)
    for limit in set(np.abs(seen).max(axis=0)):
        if LEAST_LIMIT < limit < np.abs(right).max():
            yield "clipped", f"is limited to ±{limit:.6g}", np.clip(right, -limit, limit)
    for limit in LIMITS:
        shorter = np.where(speed > limit, w * limit / np.where(speed > 0, speed, 1.0), w)
        yield (
            "clipped",
            f"is computed from ω limited to ±{limit:g}",
            exact(np.clip(w, -limit, limit), moments),
        )
        yield "clipped", f"is computed from ω whose length is limited to {limit:g}", exact(shorter, moments)
    rank = np.argsort(np.argsort(np.abs(w), axis=1), axis=1)
    for place, text in enumerate(("smallest", "middle", "largest")):
        sentence = (
            f"is zero where |{{wk}}| is the {text} of the three: the product {{wi}}{{wj}} is dropped there"
        )
        yield "missing-component", sentence, np.where(rank == place, 0.0, right)
    for least in 10.0 ** -np.arange(13):
        for values in (
            exact(np.where(np.abs(w) < least, 0.0, w), moments),
            np.where(np.abs(right) < least, 0.0, right),
        ):
            yield "clipped", "is zero where ω or {c} itself is small: small values are cut off", values
