"""Tolerances: how close an answer must be, and why. None has a default."""

from polhode.judging.outcome import Tolerance


def relative(limit: float, *, because: str) -> Tolerance:
    """Return the tolerance of a difference relative to the largest exact number of all inputs."""
    return Tolerance(limit=limit, reason=because)


def absolute(limit: float, *, because: str) -> Tolerance:
    """Return the tolerance of the absolute difference of each number."""
    return Tolerance(rtol=0.0, atol=limit, reason=because)


def close(*, rtol: float, atol: float, because: str) -> Tolerance:
    """Return the tolerance of each number: ``atol`` plus ``rtol`` times the exact number."""
    return Tolerance(rtol=rtol, atol=atol, reason=because)


def at_most(limit: float, *, because: str) -> Tolerance:
    """Return the greatest value that a count or a measured error may have."""
    return Tolerance(limit=limit, reason=because)
