"""The source of a submission to look at: its cells line by line, marked where an exception was raised or a syntax error lies."""

import difflib
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from ecp.outcome import SceneEnd
from service.grading.submission import BREAK, SourceLocation, Submission, source_locations
from service.sandbox.wire import text

MOST_LINES = 2000


@dataclass(frozen=True)
class Mark:
    """What a line has to do with the scene end at that place in the report: it stopped the code (``raised``), or led there."""

    scene_end: int
    raised: bool
    sentence: str


@dataclass(frozen=True)
class Line:
    """A line by its number from 1, with its marks."""

    number: int
    text: str
    marks: list[Mark] = field(default_factory=list)


@dataclass(frozen=True)
class ShownCell:
    """A cell by its place from 1, ``name`` as a traceback calls it; ``left_out`` lines at its end are too many to show."""

    place: int
    name: str
    lines: list[Line]
    left_out: int


def cells(submission: Submission, scene_ends: Sequence[SceneEnd]) -> list[ShownCell]:
    """The cells with their lines, marked by what the tracebacks of ``scene_ends`` say; at most MOST_LINES lines in all."""
    marks = _marks(scene_ends)
    shown, room = [], MOST_LINES
    for place, cell in enumerate(submission.cells(), start=1):
        lines = split(cell.source)
        many = min(len(lines), max(room, _last(marks, cell.name)))
        numbered = [Line(n, line, marks.get(SourceLocation(cell.name, n), [])) for n, line in enumerate(lines[:many], start=1)]
        shown.append(ShownCell(place, cell.name, numbered, len(lines) - many))
        room = max(0, room - many)
    return shown


def split(source: str) -> list[str]:
    """The lines as Python counts them, each harmless to show."""
    plain = BREAK.sub("\n", source)
    return text(plain, len(plain)).removesuffix("\n").split("\n")


def _marks(scene_ends: Iterable[SceneEnd]) -> dict[SourceLocation, list[Mark]]:
    marks: dict[SourceLocation, list[Mark]] = {}
    for number, scene_end in enumerate(scene_ends):
        for depth, place in enumerate(reversed(source_locations(scene_end))):
            known = marks.setdefault(place, [])
            if all((mark.sentence, mark.raised) != (scene_end.sentence, depth == 0) for mark in known):
                known.append(Mark(number, depth == 0, scene_end.sentence))
    return marks


def _last(marks: Iterable[SourceLocation], cell: str) -> int:
    return max((place.line for place in marks if place.cell == cell), default=0)


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
