"""The notebook's checks: each prints one ✓/✗ line and returns True or False.

Signatures and default tolerances are the course notebook's, so that its cells run unchanged.
An answer of a wrong kind (None, text, NaN, another shape) makes a ✗ that says so; nothing is raised.
"""

from collections.abc import Callable
from typing import Any

from ecp import judge
from ecp.claims import Claim, claim
from ecp.judge import Verdict

watchers: list[Callable[[Claim], None]] = []
"""Called with each claim; a server that grades a whole notebook adds one, a notebook never needs it."""


def close(got: Any, expected: Any, label: str, rtol: float = 1e-6, atol: float = 1e-9) -> bool:
    """Check that ``got`` equals ``expected`` to ``atol + rtol·|expected|``: an array of its shape, or one number for all of it."""
    return _print(claim("close", label, {"got": got, "expected": expected}, {"rtol": rtol, "atol": atol}))


def conserved(series: Any, label: str, rel_drift: float = 1e-6) -> bool:
    """Check that a series (n,) stays at its first value to the relative ``rel_drift``."""
    return _print(claim("conserved", label, {"series": series}, {"rel_drift": rel_drift}))


def check(condition: Any, label: str, detail: str = "") -> bool:
    """Check that ``condition`` is True; ``detail`` is shown in brackets."""
    return _print(claim("check", label, {"condition": condition}, {}, detail))


def positive(value: Any, label: str) -> bool:
    """Check that ``value``, a number or an array, is above zero everywhere."""
    return _print(claim("positive", label, {"value": value}, {}))


def below(value: Any, limit: float, label: str) -> bool:
    """Check that ``value``, a number or an array, is at most ``limit`` everywhere."""
    return _print(claim("below", label, {"value": value}, {"limit": limit}))


def _print(made: Claim) -> bool:
    judgement = made.judged()
    print(judge.line(judgement.verdict, made.label, judgement.detail))
    for watcher in watchers:
        watcher(made)
    return judgement.verdict is Verdict.PASS
