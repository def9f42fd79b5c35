"""The source of a submission to look at: its cells line by line, marked where an exception was raised or a syntax error lies."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from ecp.outcome import SceneEnding
from service.grading.places import BREAK, Place, places
from service.grading.submission import Submission
from service.sandbox.wire import text

MOST_LINES = 2000


@dataclass(frozen=True)
class Mark:
    """What a line has to do with the ``ending`` at that place in the report: it stopped the code (``raised``), or led there."""

    ending: int
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


def cells(submission: Submission, endings: Sequence[SceneEnding]) -> list[ShownCell]:
    """The cells with their lines, marked by what the tracebacks of ``endings`` say; at most MOST_LINES lines in all."""
    marks = _marks(endings)
    shown, room = [], MOST_LINES
    for place, cell in enumerate(submission.cells(), start=1):
        lines = split(cell.source)
        many = min(len(lines), max(room, _last(marks, cell.name)))
        numbered = [Line(n, line, marks.get(Place(cell.name, n), [])) for n, line in enumerate(lines[:many], start=1)]
        shown.append(ShownCell(place, cell.name, numbered, len(lines) - many))
        room = max(0, room - many)
    return shown


def split(source: str) -> list[str]:
    """The lines as Python counts them, each harmless to show."""
    plain = BREAK.sub("\n", source)
    return text(plain, len(plain)).removesuffix("\n").split("\n")


def _marks(endings: Iterable[SceneEnding]) -> dict[Place, list[Mark]]:
    marks: dict[Place, list[Mark]] = {}
    for number, ending in enumerate(endings):
        for depth, place in enumerate(reversed(places(ending))):
            known = marks.setdefault(place, [])
            if all((mark.sentence, mark.raised) != (ending.sentence, depth == 0) for mark in known):
                known.append(Mark(number, depth == 0, ending.sentence))
    return marks


def _last(marks: Iterable[Place], cell: str) -> int:
    return max((place.line for place in marks if place.cell == cell), default=0)
