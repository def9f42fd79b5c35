"""The notebook's checks: each prints one ✓/✗ line and returns True or False.

The default tolerances are the course notebook's own, so that its cells run unchanged.
"""

from typing import Any

from numpy.typing import ArrayLike

from ecp import judge
from ecp.judge import Judgement, Verdict


def check(label: str, ok: Any, detail: str = "") -> bool:
    """A claim of your own: ``ok`` must be True; ``detail`` is shown in brackets."""
    return _tell(label, judge.holds(ok, detail or str(ok)))


def close(label: str, got: ArrayLike, expected: ArrayLike, rtol: float = 1e-6, atol: float = 1e-9) -> bool:
    """``got`` equals ``expected`` to ``atol + rtol·|expected|``, shapes included."""
    return _tell(label, judge.close(got, expected, rtol, atol))


def conserved(label: str, series: ArrayLike, limit: float = 1e-6) -> bool:
    """A series (n,) stays at its first value to the relative ``limit``."""
    return _tell(label, judge.conserved(series, limit))


def below(label: str, value: ArrayLike, limit: float) -> bool:
    """``value`` (or the largest of many) is at most ``limit``."""
    return _tell(label, judge.below(value, limit))


def positive(label: str, value: ArrayLike) -> bool:
    """``value`` (or the smallest of many) is above zero."""
    return _tell(label, judge.positive(value))


def _tell(label: str, judgement: Judgement) -> bool:
    print(judge.line(judgement.verdict, label, judgement.detail))
    return judgement.verdict is Verdict.PASS
