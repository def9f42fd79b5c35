"""How a source differs from the one before it, in bounded time: comparing lines can take the square of their number and more."""

import difflib
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from service.grading.submission import Submission
from service.web.source import split

MOST_LINES = 2000
MOST_WORK = 2e7  # steps of the comparison at worst: some seconds
AROUND = 3
SIGNS = {"same": " ", "gone": "−", "new": "+"}


@dataclass(frozen=True)
class Changed:
    """A line of a difference: its ``kind``, a key of SIGNS, and its number before and now, where it is there."""

    kind: str
    before: int | None
    now: int | None
    text: str


class TooLong(Exception):
    """The two differ in too much to be compared line by line."""


def difference(before: Submission, now: Submission) -> list[list[Changed]]:
    """The changed stretches with some lines around each, of the code alone; TooLong where that would take too long."""
    old, new = _lines(before), _lines(now)
    head = _alike(old, new)
    tail = _alike(old[head:][::-1], new[head:][::-1])
    first = max(0, head - AROUND)
    a, b = (lines[first : len(lines) - max(0, tail - AROUND)] for lines in (old, new))
    if max(len(a), len(b)) > MOST_LINES or _work(a, b) > MOST_WORK:
        raise TooLong
    groups = difflib.SequenceMatcher(None, a, b).get_grouped_opcodes(AROUND)
    return [[line for block in group for line in _told(block, a, b, first + 1)] for group in groups]


def _lines(submission: Submission) -> list[str]:
    cells = submission.cells()
    if len(cells) == 1:
        return split(cells[0].source)
    return [line for cell in cells for line in (f"# {cell.name}", *split(cell.source))]


def _alike(a: Sequence[str], b: Sequence[str]) -> int:
    """How many lines at the beginning are the same."""
    return next((k for k, (x, y) in enumerate(zip(a, b, strict=False)) if x != y), min(len(a), len(b)))


def _work(a: Sequence[str], b: Sequence[str]) -> float:
    """At most so many steps: equal pairs of lines, but for those that difflib leaves aside as too common, once a match."""
    mine, theirs = Counter(a), Counter(b)
    common = len(b) // 100 + 1 if len(b) >= 200 else len(b)
    pairs = sum(many * theirs[line] for line, many in mine.items() if theirs[line] <= common)
    return (len(a) + pairs) * min(len(a), len(b))


def _told(block: tuple[str, int, int, int, int], a: Sequence[str], b: Sequence[str], first: int) -> Iterator[Changed]:
    """The lines of one block, whose numbers begin at ``first``."""
    tag, i, k, j, m = block
    if tag == "equal":
        yield from (Changed("same", first + i + n, first + j + n, a[i + n]) for n in range(k - i))
    else:
        yield from (Changed("gone", first + n, None, a[n]) for n in range(i, k))
        yield from (Changed("new", None, first + n, b[n]) for n in range(j, m))
