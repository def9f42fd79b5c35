"""The checks of a validation cell: each prints one ✓/✗ line.

A ✗ also raises AssertionError, unless ``strict`` is false.
"""

from typing import Any

import numpy as np

MARKS = {True: "✓", False: "✗"}


def check(passed: Any, label: str, detail: str = "", *, strict: bool = True) -> bool:
    """Check that ``passed`` is true; return whether it is. ``detail`` is the text in the brackets.

    >>> from ecp import validate
    >>> validate.check(1.1 > 1.0, "the spin grows", "growth 1.1")
    ✓  the spin grows   [growth 1.1]
    True
    """
    ok = bool(passed)
    print(f"{MARKS[ok]}  {label}" + (f"   [{detail}]" if detail else ""))
    if strict and not ok:
        raise AssertionError(f"{label}: {detail}" if detail else label)
    return ok


def close(
    got: Any, expected: Any, label: str, *, rtol: float = 1e-6, atol: float = 1e-9, strict: bool = True
) -> bool:
    """Check that ``got`` equals ``expected`` to ``atol + rtol·|expected|``, as ``numpy.allclose`` compares
    them: shapes are broadcast.

    >>> from ecp import validate
    >>> validate.close([1.0, 2.0], [1.0, 2.5], "moments agree", strict=False)
    ✗  moments agree   [max|Δ| = 0.5 (rtol=1e-06, atol=1e-09)]
    False
    """
    ok, tolerance = np.allclose(got, expected, rtol=rtol, atol=atol), f"(rtol={rtol:g}, atol={atol:g})"
    if np.size(got) == np.size(expected) == 1:
        detail = f"got {_number(got)} vs expected {_number(expected)} {tolerance}"
    else:
        largest = np.max(np.abs(np.subtract(got, expected)))
        detail = f"max|Δ| = {_number(largest)} {tolerance}"
    return check(ok, label, detail, strict=strict)


def conserved(series: Any, label: str, *, rel_drift: float = 1e-4, strict: bool = True) -> bool:
    """Check that a series (n,) stays at its first value to less than the relative ``rel_drift``, absolute if
    that value is 0.

    >>> from ecp import validate
    >>> validate.conserved([2.0, 2.0, 2.0], "energy is conserved")
    ✓  energy is conserved   [max relative drift = 0 (limit 0.0001)]
    True
    """
    values = np.asarray(series, dtype=float)
    drift = np.max(np.abs(values - values[0])) / (abs(values[0]) or 1.0)
    detail = f"max relative drift = {_number(drift)} (limit {rel_drift:g})"
    return check(drift < rel_drift, label, detail, strict=strict)


def positive(value: Any, label: str, *, strict: bool = True) -> bool:
    """Check that ``value``, a number or an array, is above 0 everywhere.

    >>> from ecp import validate
    >>> validate.positive([2.0, 3.0, 4.0], "moments are positive")
    ✓  moments are positive   [value = 2]
    True
    """
    least = np.min(value)
    return check(least > 0, label, f"value = {_number(least)}", strict=strict)


def below(value: Any, limit: float, label: str, detail: str = "", *, strict: bool = True) -> bool:
    """Check that ``value``, a number or an array, is below ``limit`` everywhere.

    >>> from ecp import validate
    >>> validate.below([0.1, 0.3], 0.2, "the error is small", strict=False)
    ✗  the error is small   [0.3 < 0.2]
    False
    """
    largest = np.max(value)
    compared = f"{_number(largest)} < {limit:.6g}"
    return check(largest < limit, label, f"{detail} [{compared}]" if detail else compared, strict=strict)


def _number(value: Any) -> str:
    """Return one number as text, a complex one as Python writes it."""
    one = np.asarray(value).item()
    return str(one) if isinstance(one, complex) else f"{one:.6g}"
