"""Read the text of a roster as a table: its separator, the line of its headings, and the lines below."""

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass

from service.store.people.roster.columns import known
from service.store.people.roster.problems import BadRoster
from service.store.people.roster.text import Text

SEPARATORS = ",;\t|"
MOST_ABOVE = 20  # lines among which the headings are looked for: some tools write a title above them
MOST_COLUMNS = 500


@dataclass(frozen=True)
class Line:
    """A line of the file, with its number from 1 and a cell for each heading."""

    number: int
    cells: Sequence[str]


@dataclass(frozen=True)
class Table:
    """The headings of a file, each once, and the lines below. ``above`` are the lines before the headings."""

    headings: Sequence[str]
    lines: Sequence[Line]
    above: Sequence[Line]
    text: Text


def read_table(text: Text, file: str) -> Table:
    """Return the table in a text. Raises BadRoster if there is none."""
    tables = [_lines(text.text, separator, file) for separator in SEPARATORS]
    lines, start = max(((lines, _start(lines)) for lines in tables), key=_understood)
    if not lines:
        raise BadRoster(f"{file} is empty: choose the file with the roster")
    if len(lines[start].cells) > MOST_COLUMNS:
        raise BadRoster(f"{file} has more than {MOST_COLUMNS} columns: leave those that are about people")
    below = [line for line in lines[start + 1 :] if any(cell.strip() for cell in line.cells)]
    headings = _unique([" ".join(cell.split()) for cell in lines[start].cells])
    return Table(headings[: _width(lines[start], below)], below, lines[:start], text)


def _lines(text: str, separator: str, file: str) -> list[Line]:
    """Return the lines that are not empty. Excel may write ``sep=;`` above them."""
    rows = csv.reader(io.StringIO(text, newline=""), delimiter=separator)
    try:
        lines = [Line(rows.line_num, row) for row in rows if row]
    except csv.Error as error:
        raise BadRoster(f"{file}, line {rows.line_num}: {error}: save the roster as CSV UTF-8") from None
    return lines[1:] if lines and lines[0].cells[0].startswith("sep=") else lines


def _start(lines: Sequence[Line]) -> int:
    """Return the place of the line with most known headings if it has at least two, else 0."""
    counts = [sum(map(known, line.cells)) for line in lines[:MOST_ABOVE]]
    best = max(counts, default=0)
    return counts.index(best) if best > 1 else 0


def _understood(candidate: tuple[Sequence[Line], int]) -> tuple[int, int]:
    """Return how many headings are understood, and how many there are."""
    lines, start = candidate
    return (sum(map(known, lines[start].cells)), len(lines[start].cells)) if lines else (0, 0)


def _width(headings: Line, below: Sequence[Line]) -> int:
    """Return the number of columns without those at the end that have neither heading nor content."""
    filled = [place for line in (headings, *below) for place, cell in enumerate(line.cells) if cell.strip()]
    return min(len(headings.cells), 1 + max(filled, default=-1))


def _unique(headings: Sequence[str]) -> list[str]:
    """Return the headings with a number where one is missing or repeated."""
    found: list[str] = []
    for number, heading in enumerate(headings, 1):
        label = heading if heading and heading not in found else f"{heading} (column {number})".strip()
        found.append(label)
    return found
