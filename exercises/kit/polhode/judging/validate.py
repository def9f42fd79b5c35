"""The notebook's checks: each prints one ✓/✗ line and returns True or False.

Signatures and default tolerances are the course notebook's. An argument of a wrong kind (None, text, NaN,
another shape) fails with a line that says so; nothing is raised.
"""

from collections.abc import Callable
from typing import Any

from polhode.judging import judge
from polhode.judging.claims import Claim, claim
from polhode.judging.judge import Verdict

watchers: list[Callable[[Claim], None]] = []
"""Called with each claim. A server that grades a whole notebook adds one; a notebook needs none."""


def close(got: Any, expected: Any, label: str, rtol: float = 1e-6, atol: float = 1e-9) -> bool:
    """Check that ``got`` equals ``expected`` to ``atol + rtol·|expected|``; return whether it does.

    Both are arrays of one shape in one unit, or one of them is a single number. Another shape fails.

    >>> from polhode.judging import validate
    >>> validate.close([1.0, 2.0], [1.0, 2.5], "moments agree")
    ✗  moments agree   [max|Δ| = 0.5 (rtol=1e-06, atol=1e-09)]
    False
    """
    return _print(claim("close", label, {"got": got, "expected": expected}, {"rtol": rtol, "atol": atol}))


def conserved(series: Any, label: str, rel_drift: float = 1e-6) -> bool:
    """Check that a series (n,) stays at its first value to the relative ``rel_drift``; return whether it
    does.

    Fewer than two values fail.

    >>> from polhode.judging import validate
    >>> validate.conserved([2.0, 2.0, 2.0], "energy is conserved")
    ✓  energy is conserved   [max relative drift = 0 (limit 1e-06)]
    True
    """
    return _print(claim("conserved", label, {"series": series}, {"rel_drift": rel_drift}))


def check(condition: Any, label: str, detail: str = "") -> bool:
    """Check that ``condition`` is True; return whether it is. ``detail`` is the text in the brackets.

    Anything but a single bool fails, an array of several or a number included.

    >>> from polhode.judging import validate
    >>> validate.check(1.1 > 1.0, "the spin grows", "growth 1.1")
    ✓  the spin grows   [growth 1.1]
    True
    """
    return _print(claim("check", label, {"condition": condition}, {}, detail))


def positive(value: Any, label: str) -> bool:
    """Check that ``value``, a number or an array, is above zero everywhere; return whether it is. An empty
    array fails.

    >>> from polhode.judging import validate
    >>> validate.positive([2.0, 3.0, 4.0], "moments are positive")
    ✓  moments are positive   [got 2 (must be > 0)]
    True
    """
    return _print(claim("positive", label, {"value": value}, {}))


def below(value: Any, limit: float, label: str) -> bool:
    """Check that ``value``, a number or an array, is at most ``limit``, in its unit, everywhere; return
    whether it is.

    An empty array fails.

    >>> from polhode.judging import validate
    >>> validate.below([0.1, 0.3], 0.2, "the error is small")
    ✗  the error is small   [got 0.3 (limit 0.2)]
    False
    """
    return _print(claim("below", label, {"value": value}, {"limit": limit}))


def _print(made: Claim) -> bool:
    judgement = made.judged()
    print(judge.line(judgement.verdict, made.label, judgement.detail))
    for watcher in watchers:
        watcher(made)
    return judgement.verdict is Verdict.PASS
