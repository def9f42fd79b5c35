"""The comparisons behind the check words: numbers and an explicit tolerance in, a judgement out.

``polhode.check`` and the server use these same functions, so both print the same line. NaN, infinity and a
wrong shape never pass.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polhode.judging.verdict import Judgement, Verdict, verdict_of

Array = NDArray[np.float64]


def close(got: ArrayLike, expected: ArrayLike, rtol: float, atol: float) -> Judgement:
    """Judge |got − expected| ≤ atol + rtol |expected| everywhere, of real or complex numbers. Shapes must be
    equal; nothing is broadcast.
    """
    seen, want = _real_or_complex(got), _real_or_complex(expected)
    tolerance = f"(rtol={rtol:g}, atol={atol:g})"
    if seen.shape != want.shape:
        return _misshapen(f"shape {seen.shape} vs expected shape {want.shape} {tolerance}")
    with np.errstate(invalid="ignore"):
        delta, allowed = np.abs(seen - want), atol + rtol * np.abs(want)
    where, margin = _worst(delta, allowed)
    found = verdict_of(bool(np.all(np.isfinite(want)) and np.all(delta <= allowed)))
    if want.ndim == 0 and not np.iscomplexobj([seen, want]):
        detail = f"got {seen:.6g} vs expected {want:.6g} {tolerance}"
        return Judgement(found, detail, float(seen), float(want), margin)
    largest = float(delta.max()) if delta.size else 0.0
    return Judgement(found, f"max|Δ| = {largest:.6g} {tolerance}", largest, 0.0, margin, where)


def within(got: ArrayLike, expected: ArrayLike, scale: ArrayLike, limit: float) -> Judgement:
    """Judge |got − expected| ≤ limit · scale everywhere. Shapes must be equal; ``scale`` is one number or an
    array of that shape.
    """
    seen, want, unit = _real(got), _real(expected), _real(scale)
    if seen.shape != want.shape:
        return _misshapen(f"shape {seen.shape} vs expected shape {want.shape} (limit {limit:g})")
    with np.errstate(invalid="ignore", divide="ignore"):
        delta = np.abs(seen - want)
        used = np.where(delta == 0, 0.0, delta / unit)
    where, margin = _worst(used, np.full_like(used, limit))
    largest = float(used.max()) if used.size else 0.0
    ok = bool(np.all(np.isfinite(want)) and np.all(used <= limit))
    return Judgement(
        verdict_of(ok), f"max|Δ|/scale = {largest:.6g} (limit {limit:g})", largest, 0.0, margin, where
    )


def conserved(series: ArrayLike, limit: float) -> Judgement:
    """Judge max |s(t)/s(0) − 1| ≤ limit for a series (n,), n ≥ 2. A series that starts at zero must stay
    zero.
    """
    values = _real(series)
    if values.ndim != 1 or values.size < 2:
        return _misshapen(f"got shape {values.shape}, expected a one-dimensional array of at least 2 values")
    with np.errstate(invalid="ignore"):
        delta, scale = np.abs(values - values[0]), abs(values[0])
        drift = delta / scale if scale > 0 else np.where(delta == 0, 0.0, np.inf)
    where, margin = _worst(drift, np.full_like(drift, limit))
    largest = float(drift.max())
    detail = f"max relative drift = {largest:.6g} (limit {limit:g})"
    return Judgement(verdict_of(bool(np.all(drift <= limit))), detail, largest, 0.0, margin, where)


def below(value: ArrayLike, limit: float) -> Judgement:
    """Judge value ≤ limit for a number, or for the largest of an array."""
    values = _real(value)
    if values.size == 0:
        return _misshapen(f"the array is empty: expected at least one number (limit {limit:g})")
    where, margin = _worst(values, np.full_like(values, limit))
    largest = float(values.max())
    ok = bool(np.all(np.isfinite(values)) and np.all(values <= limit))
    return Judgement(verdict_of(ok), f"got {largest:.6g} (limit {limit:g})", largest, None, margin, where)


def positive(value: ArrayLike) -> Judgement:
    """Judge value > 0 for a number, or for the smallest of an array."""
    values = _real(value)
    if values.size == 0:
        return Judgement(Verdict.FAIL, "the array is empty: expected at least one number (must be > 0)")
    smallest = float(values.min())
    return Judgement(
        verdict_of(bool(np.all(np.isfinite(values)) and smallest > 0)),
        f"got {smallest:.6g} (must be > 0)",
        smallest,
    )


def holds(ok: Any, detail: str) -> Judgement:
    """Judge a claim that has its own detail text. Only a true bool passes; an array or NaN does not."""
    return Judgement(verdict_of(isinstance(ok, bool | np.bool_) and bool(ok)), detail)


def _misshapen(detail: str) -> Judgement:
    return Judgement(Verdict.FAIL, detail, misshapen=True)


def least_margin(delta: Array, allowed: Array) -> float | None:
    """Return allowed / measured where it is least, None if nothing deviates."""
    return _worst(delta, allowed)[1]


def _worst(delta: Array, allowed: Array) -> tuple[tuple[int, ...] | None, float | None]:
    """Return index and margin of the value that uses most of its allowance. NaN is the worst."""
    if delta.size == 0:
        return None, None
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        used = np.where(delta == 0, 0.0, delta / allowed)
    used = np.where(np.isnan(used), np.inf, used)
    flat = int(np.argmax(used))
    where: Sequence[np.intp] = np.unravel_index(flat, delta.shape)
    most = float(used.flat[flat])
    return tuple(int(i) for i in where), (None if most == 0.0 else 1.0 / most)


def _real_or_complex(x: ArrayLike) -> Array | NDArray[np.complex128]:
    array = np.asarray(x)
    return array.astype(complex) if array.dtype.kind == "c" else _real(array)


def _real(x: ArrayLike) -> Array:
    array = np.asarray(x)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"a check compares real numbers, not {array.dtype}")
    return array.astype(float)
