"""Source view and diff of a submission: cells line by line, with the lines marked at which code failed."""

import difflib
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from polhode.report.report import Report
from polhode.report.student_line import BREAK
from service.grading.submission import SourceLocation, Submission, source_locations
from service.sandbox.untrusted_text import text
from service.store.course.comments import Comment

MOST_LINES = 2000
MOST_WORK = 2e7  # upper bound of comparison steps, a few seconds
CONTEXT = 3  # unchanged lines around a change
SIGNS = {"same": " ", "gone": "−", "new": "+"}


@dataclass(frozen=True)
class Mark:
    """Why a line is marked, in ``words``, with the ``address`` of what the page says about it.

    ``kind`` is "failing" for a line that raised, "caller" for one that called it, and "suspect" for one that
    a cause is about.
    """

    kind: str
    words: str
    address: str


Marks = Mapping[SourceLocation, list[Mark]]


@dataclass(frozen=True)
class Line:
    """A line with its number, from 1, its marks, and the staff's comments on it."""

    number: int
    text: str
    marks: list[Mark] = field(default_factory=list)
    comments: list[Comment] = field(default_factory=list)


@dataclass(frozen=True)
class ShownCell:
    """A cell with its number ``place``, from 1, and its name in tracebacks.

    ``left_out`` lines at its end are not shown.
    """

    place: int
    name: str
    lines: list[Line]
    left_out: int


def cells(submission: Submission, marks: Marks, comments: Iterable[Comment] = ()) -> list[ShownCell]:
    """Return the cells with their lines, with the ``marks`` and ``comments`` on them.

    The cells have at most MOST_LINES lines in total, or more if needed to reach the last line with a mark or
    comment.
    """
    commented: dict[tuple[int, int], list[Comment]] = {}
    for one in comments:
        commented.setdefault((one.cell, one.line), []).append(one)
    shown, remaining = [], MOST_LINES
    for place, cell in enumerate(submission.cells(), start=1):
        lines = split(cell.source)
        last_comment = max((line for at, line in commented if at == place), default=0)
        many = min(len(lines), max(remaining, _last_marked(marks, cell.name), last_comment))
        numbered = [
            Line(n, line, marks.get(SourceLocation(cell.name, n), []), commented.get((place, n), []))
            for n, line in enumerate(lines[:many], start=1)
        ]
        shown.append(ShownCell(place, cell.name, numbered, len(lines) - many))
        remaining = max(0, remaining - many)
    return shown


def split(source: str) -> list[str]:
    """Return the lines as Python counts them, with unprintable characters replaced."""
    plain = BREAK.sub("\n", source)
    return text(plain, len(plain)).removesuffix("\n").split("\n")


def marks(report: Report) -> Marks:
    """Return the marks of a report: where code raised, who called it, and the lines that causes are about.

    An error that a cause of the report states has the address of the cause, another that of its scene end.
    """
    found: dict[SourceLocation, list[Mark]] = {}
    causes = report.overview().causes
    ends = [(cause.scene_end, f"#cause-{cause.number}", "") for cause in causes if cause.scene_end]
    ends += [(end, f"#end-{number}", f": {end.sentence}") for number, end in enumerate(report.stops())]
    for end, address, said in ends:
        for depth, place in enumerate(reversed(source_locations(end))):
            kind, words = ("caller", "called from here") if depth else ("failing", "raised here")
            mark = Mark(kind, words + said, address)
            if mark not in found.setdefault(place, []):
                found[place].append(mark)
    for cause in causes:
        if cause.line is not None and cause.scene_end is None:
            place = SourceLocation(cause.line.cell, cause.line.number)
            found.setdefault(place, []).append(
                Mark("suspect", f"cause {cause.number}", f"#cause-{cause.number}")
            )
    return found


def _last_marked(marks: Iterable[SourceLocation], cell: str) -> int:
    return max((place.line for place in marks if place.cell == cell), default=0)


@dataclass(frozen=True)
class Changed:
    """A line of a diff: its ``kind``, a key of SIGNS, and its line numbers in the earlier and later
    source, None if absent.
    """

    kind: str
    before: int | None
    now: int | None
    text: str


class TooLong(Exception):
    """The sources differ too much for a line-by-line comparison."""


def difference(before: Submission, now: Submission) -> list[list[Changed]]:
    """Return the changed blocks of code, each with CONTEXT lines around it.

    Raises TooLong if comparing would take too long.
    """
    old, new = _lines(before), _lines(now)
    head = _common_prefix(old, new)
    tail = _common_prefix(old[head:][::-1], new[head:][::-1])
    first = max(0, head - CONTEXT)
    a, b = (lines[first : len(lines) - max(0, tail - CONTEXT)] for lines in (old, new))
    if max(len(a), len(b)) > MOST_LINES or _comparison_steps(a, b) > MOST_WORK:
        raise TooLong
    groups = difflib.SequenceMatcher(None, a, b).get_grouped_opcodes(CONTEXT)
    return [[line for block in group for line in _changed_lines(block, a, b, first + 1)] for group in groups]


def _lines(submission: Submission) -> list[str]:
    cells = submission.cells()
    if len(cells) == 1:
        return split(cells[0].source)
    return [line for cell in cells for line in (f"# {cell.name}", *split(cell.source))]


def _common_prefix(a: Sequence[str], b: Sequence[str]) -> int:
    """Return the number of equal lines at the beginning."""
    return next((k for k, (x, y) in enumerate(zip(a, b, strict=False)) if x != y), min(len(a), len(b)))


def _comparison_steps(a: Sequence[str], b: Sequence[str]) -> float:
    """Return an upper bound of difflib's steps: pairs of equal lines, without those it ignores as too
    common, once per match.
    """
    counts_a, counts_b = Counter(a), Counter(b)
    common = len(b) // 100 + 1 if len(b) >= 200 else len(b)
    pairs = sum(many * counts_b[line] for line, many in counts_a.items() if counts_b[line] <= common)
    return (len(a) + pairs) * min(len(a), len(b))


def _changed_lines(
    block: tuple[str, int, int, int, int], a: Sequence[str], b: Sequence[str], first: int
) -> Iterator[Changed]:
    """Yield the lines of one difflib block.

    ``first`` is the number of the first line of ``a`` and ``b``.
    """
    tag, i, k, j, m = block
    if tag == "equal":
        yield from (Changed("same", first + i + n, first + j + n, a[i + n]) for n in range(k - i))
    else:
        yield from (Changed("gone", first + n, None, a[n]) for n in range(i, k))
        yield from (Changed("new", None, first + n, b[n]) for n in range(j, m))
