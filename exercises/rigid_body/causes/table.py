"""Mistakes that predict numbers: each row of the table holds the rates that one wrong formula gives at the
probes.

Forms (term_fit.py) cover wrong indices, signs, factors and divisors. The table covers the rest: missing
brackets, absolute values, floor division, clipping, normalized or inverted arguments, powers and roots.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import reference
from exercises.rigid_body.causes.agreement import agree
from exercises.rigid_body.causes.errors import COMPONENT, DIFFERENCE, MOMENT, SPIN, Slip

Array = NDArray[np.float64]
LEAST_LIMIT = 1e-9  # of rates that were clipped, not lost
OVERWRITTEN = "{c} is computed from rates that already replaced ω: keep ω until all three are computed"
SMALL = tuple(10.0**-k for k in range(13))  # thresholds below which values may have been set to zero
LIMITS = (1.0, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0, 100.0, 1000.0)  # to which ω may have been clipped


class Mistake(NamedTuple):
    """The ``values`` (n, 3) of a wrong formula. ``sentence`` has the fields c, d, ii, ij, ik, wi, wj, wk:
    symbols of a component.
    """

    code: str
    sentence: str
    values: Array


def table(w: Array, moments: Array, seen: Array) -> list[Mistake]:
    """Return every row for ω and I (n, 3). The limit of clipped rates is read from the ``seen`` ones."""
    with np.errstate(all="ignore"):
        return [
            *_brackets(w, moments),
            *_absolute(w, moments),
            *_whole_numbers(w, moments),
            *_clipped(w, moments, seen),
            *_dropped(w, moments),
            *_arguments(w, moments),
        ]


def readings(found: list[Mistake], column: Array, w: Array, moments: Array, k: int) -> list[list[Slip]]:
    """Return the errors that reproduce the ``column`` (n,) of component ``k``: a mistake of the table, or its
    negative.
    """
    readings_: dict[str, list[Slip]] = {}
    for mistake in found:
        for sign in (1.0, -1.0):
            if np.all(agree(column[:, None], sign * mistake.values[:, k : k + 1], w, moments)[:, 0]):
                slips = [Slip(mistake.code, mistake.sentence, 0.0, k, mistake.sentence.format(**_symbols(k)))]
                if sign < 0:
                    slips.append(Slip("sign-flipped", "sign", 0.0, k, f"{COMPONENT[k]} has the opposite sign"))
                readings_.setdefault(mistake.sentence, slips)
    return list(readings_.values())


def _symbols(k: int) -> dict[str, str]:
    i, j = (k + 1) % 3, (k + 2) % 3
    spins = {"wi": SPIN[i], "wj": SPIN[j], "wk": SPIN[k]}
    return {"c": COMPONENT[k], "d": DIFFERENCE[k], "ii": MOMENT[i], "ij": MOMENT[j], "ik": MOMENT[k]} | spins


def _parts(w: Array, moments: Array) -> tuple[Array, Array, Array, Array]:
    """Return Iᵢ, Iⱼ, ωᵢ and ωⱼ (n, 3) of each component."""
    return np.roll(moments, -1, 1), np.roll(moments, -2, 1), np.roll(w, -1, 1), np.roll(w, -2, 1)


def _exact(w: Array, moments: Array) -> Array:
    return reference.euler_rhs(w.T, moments.T).T


def _one_after_the_other(w: Array, moments: Array) -> Array:
    """Return rates (n, 3), each of which replaces its ω before the next is computed."""
    rates = w.copy()
    for k in range(3):
        rates[:, k] = _exact(rates, moments)[:, k]
    return rates


def _brackets(w: Array, moments: Array) -> Iterator[Mistake]:
    (ii, ij, wi, wj), ik = _parts(w, moments), moments
    for computed, values in (
        ("{ii} − {ij}·{wi}{wj}/{ik}", ii - ij * wi * wj / ik),
        ("{ii}·{wi}{wj} − {ij}·{wi}{wj}/{ik}", ii * wi * wj - ij * wi * wj / ik),
        ("({ii} − {ij}·{wi}{wj})/{ik}", (ii - ij * wi * wj) / ik),
        ("{ii} − {ij}·{wi}{wj}", ii - ij * wi * wj),
        ("({ii} − {ij}/{ik})·{wi}{wj}", (ii - ij / ik) * wi * wj),
        ("({ii} − {ij})/({ik}·{wi}{wj})", (ii - ij) / (ik * wi * wj)),
        ("({ii} − {ij})·{wi}/({ik}·{wj})", (ii - ij) * wi / (ik * wj)),
        ("({ii} − {ij})·{wj}/({ik}·{wi})", (ii - ij) * wj / (ik * wi)),
    ):
        yield Mistake(
            "missing-brackets", "{c} is computed as " + computed + " instead of {d}·{wi}{wj}/{ik}: check the brackets", values
        )


def _absolute(w: Array, moments: Array) -> Iterator[Mistake]:
    (ii, ij, wi, wj), ik = _parts(w, moments), moments
    exact = (ii - ij) * wi * wj / ik
    for of_what, values in (
        ("the whole result", np.abs(exact)),
        ("the difference {d}", np.abs(ii - ij) * wi * wj / ik),
        ("the product {wi}{wj}", (ii - ij) * np.abs(wi * wj) / ik),
        ("{wi}", (ii - ij) * np.abs(wi) * wj / ik),
        ("{wj}", (ii - ij) * wi * np.abs(wj) / ik),
    ):
        yield Mistake("absolute-value", "{c} takes the absolute value of " + of_what + ": its sign is lost", values)


def _whole_numbers(w: Array, moments: Array) -> Iterator[Mistake]:
    (ii, ij, wi, wj), ik = _parts(w, moments), moments
    sentence = "{c} uses floor division (//), which drops the fraction: divide by {ik} with /"
    yield Mistake("floor-division", sentence, np.floor((ii - ij) * wi * wj / ik))
    yield Mistake("floor-division", sentence, (ii - ij) // ik * wi * wj)
    yield Mistake("floor-division", sentence, (ii - ij) * wi // ik * wj)


def _clipped(w: Array, moments: Array, seen: Array) -> Iterator[Mistake]:
    exact = _exact(w, moments)
    yield Mistake("clipped", "{c} is never negative: negative values are cut to zero", np.maximum(exact, 0.0))
    yield Mistake("clipped", "{c} is never positive: positive values are cut to zero", np.minimum(exact, 0.0))
    for limit in {float(x) for x in np.abs(seen).max(axis=0)}:
        if np.isfinite(limit) and LEAST_LIMIT < limit < np.abs(exact).max():
            yield Mistake("clipped", f"{{c}} is limited to ±{limit:.6g}", np.clip(exact, -limit, limit))
    speed = np.linalg.norm(w, axis=1, keepdims=True)
    for limit in LIMITS:
        yield Mistake(
            "clipped", f"each ω is limited to ±{limit:g} before {{c}} is computed", _exact(np.clip(w, -limit, limit), moments)
        )
        shorter = np.where(speed > limit, w * limit / np.where(speed > 0, speed, 1.0), w)
        yield Mistake("clipped", f"|ω| is limited to {limit:g} before {{c}} is computed", _exact(shorter, moments))


def _dropped(w: Array, moments: Array) -> Iterator[Mistake]:
    exact, rank = _exact(w, moments), np.argsort(np.argsort(np.abs(w), axis=1), axis=1)
    for place, name in enumerate(("smallest", "middle", "largest")):
        sentence = f"{{c}} is zero where |{{wk}}| is the {name} of the three: the product {{wi}}{{wj}} is dropped there"
        yield Mistake("missing-component", sentence, np.where(rank == place, 0.0, exact))
    for least in SMALL:
        for values in (_exact(np.where(np.abs(w) < least, 0.0, w), moments), np.where(np.abs(exact) < least, 0.0, exact)):
            yield Mistake("clipped", "{c} is zero where ω or {c} itself is small: small values are cut off", values)


def _arguments(w: Array, moments: Array) -> Iterator[Mistake]:
    (ii, ij, wi, wj), exact = _parts(w, moments), _exact(w, moments)
    speed = np.linalg.norm(w, axis=1, keepdims=True)
    speed = np.where(speed > 0, speed, 1.0)
    yield Mistake("normalised", "{c} is computed from the unit vector ω/|ω|: use ω itself", exact / speed**2)
    yield Mistake("normalised", "{c} lacks a factor |ω|: one of its ω comes from the unit vector ω/|ω|", exact / speed)
    length = np.linalg.norm(moments * w, axis=1, keepdims=True)
    yield Mistake("normalised", "{c} lacks a factor |L|: L comes from a unit vector", exact / np.where(length > 0, length, 1.0))
    largest = moments.max(axis=1)
    for name, size in (("|I|", np.linalg.norm(moments, axis=1)), ("their sum", moments.sum(axis=1)), ("the largest", largest)):
        sentence = f"{{c}} has moments divided by {name} in one place and not in another"
        yield Mistake("normalised", sentence, exact / size[:, None])
    for name, size in (("largest", moments.max(axis=1)), ("middle", np.median(moments, axis=1)), ("smallest", moments.min(axis=1))):
        sentence = f"{{c}} is divided by the {name} of the moments instead of {{ik}}"
        yield Mistake("wrong-divisor", sentence, exact * moments / size[:, None])
    yield Mistake("inverted-moments", "{c} has I and 1/I swapped: use {d}/{ik}", _exact(w, 1 / moments))
    yield Mistake("wrong-power", "{c} has the squares {wi}² and {wj}² instead of {wi} and {wj}", exact * wi * wj)
    yield Mistake("wrong-power", "{c} has {wi}²{wj} instead of {wi}{wj}", exact * wi)
    yield Mistake("wrong-power", "{c} has {wi}{wj}² instead of {wi}{wj}", exact * wj)
    for more, divisor in (("", moments), (", and {ik}² instead of {ik}", moments**2)):
        yield Mistake("wrong-power", "{c} has {ii}² − {ij}² instead of {d}" + more, (ii**2 - ij**2) * wi * wj / divisor)
    yield Mistake("wrong-power", "{c} has {wi}{wj}{wk} instead of {wi}{wj}", exact * w)
    yield Mistake("wrong-quantity", OVERWRITTEN, _one_after_the_other(w, moments))
    yield Mistake("wrong-power", "{c} is the square of the right value, with its sign", exact * np.abs(exact))
    yield Mistake("wrong-power", "{c} is the square of the right value", exact**2)
    yield Mistake(
        "wrong-power", "{c} is the square root of the right value, with its sign", np.sign(exact) * np.sqrt(np.abs(exact))
    )
    yield Mistake("wrong-power", "{c} is multiplied by |ω|", exact * speed)
    yield Mistake(
        "wrong-quantity", "{c} is multiplied by ω·L, twice the energy", exact * (moments * w**2).sum(axis=1, keepdims=True)
    )
