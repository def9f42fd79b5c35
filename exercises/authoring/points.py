"""The points of an exercise, divided among its checks."""

from collections.abc import Sequence


def allotted(points: int, checks: Sequence[Sequence[str]], shares: Sequence[float]) -> dict[str, int]:
    """Return the points of each check by its id, ``points`` in all.

    ``checks`` are those of each question and ``shares`` the questions' shares. Checks of one question are
    worth the same up to rounding; what is left goes to its last ones, which have new inputs.
    """
    found = dict[str, int]()
    for ids, of_question in zip(checks, _parts(points, shares), strict=True):
        each, left = divmod(of_question, len(ids))
        found |= {id: each + (k >= len(ids) - left) for k, id in enumerate(ids)}
    return found


def _parts(points: int, shares: Sequence[float]) -> list[int]:
    """Return whole numbers in the ratio of ``shares``; what is left goes to the largest remainders, of equal
    ones to the last.
    """
    exact = [points * share / sum(shares) for share in shares]
    found = [int(value + 1e-9) for value in exact]
    by_remainder = sorted(range(len(found)), key=lambda k: (round(found[k] - exact[k], 9), -k))
    for k in by_remainder[: points - sum(found)]:
        found[k] += 1
    return found
