"""The points of an exercise, divided among its checks."""

from collections.abc import Sequence


def allotted(points: int, checks: Sequence[Sequence[str]], shares: Sequence[float]) -> dict[str, int]:
    """Return the points of each check by its id, ``points`` in all.

    ``checks`` are those of each question and ``shares`` the questions' shares. Checks of one question are
    worth the same up to rounding. What is left goes to the largest remainders, of equal ones to the last
    check, which has new inputs.
    """
    whole = sum(shares)
    exact = {
        id: points * share / whole / len(ids) for ids, share in zip(checks, shares, strict=True) for id in ids
    }
    found = {id: int(value + 1e-9) for id, value in exact.items()}
    order = {id: k for k, id in enumerate(exact)}
    by_remainder = sorted(exact, key=lambda id: (round(found[id] - exact[id], 9), -order[id]))
    for id in by_remainder[: points - sum(found.values())]:
        found[id] += 1
    return found
