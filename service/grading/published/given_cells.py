"""The published notebook's own cells, run in place of the student's copies.

Finding the copies is work of the host, so it is bounded: equal texts are found by their lines, and similar
ones by counting pairs of words, in at most MOST_PARTS parts of a submission.
"""

import re
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

from exercises.authoring.assignments.assignment import PublishedCell
from exercises.authoring.publishing.publish import IS_BROUGHT
from service.sandbox.guest.cells.jupytext_cells import MARK, MOST_PIECES
from service.sandbox.job import Cell

ALIKE = 0.6  # least share of the words of an edited copy and of the published cell that both have in pairs
MOST_PARTS = 1000
MOST_PADDING = 1 << 20  # empty lines before all parts, which keep the numbers of their lines
WORD = re.compile(r"\w+|[^\w\s]")


class Part(NamedTuple):
    """Lines of a student's cell: the index of the cell, the first line and the one behind the last."""

    of: int
    first: int
    end: int


def with_published(cells: Sequence[Cell], published: Sequence[PublishedCell]) -> tuple[Cell, ...]:
    """Return the student's ``cells`` with the given ones of the ``published`` notebook in place of their
    copies.

    A copy has the same id or nearly the same text; it may be a part of a cell or of a Python file. Where a
    cell has several copies, the last one counts. An edited copy runs too, before the published cell, because
    students also write their solution there.

    The cells above the first solution run first. Another cell without a copy stands before the next one that
    has one, or before the next solution with its id, else at the end.
    """
    given = [cell for cell in published if cell.is_given]
    lines = [_lines(cell.source) for cell in cells]
    parts = _all_parts(lines, given)
    taken = [_taken(cells[part.of], lines[part.of], part) for part in parts]
    copies = _copies(taken, given)
    last = {copy: at for at, copy in copies.items()}
    places = {cell.id: place for place, cell in enumerate(published) if cell.id}
    first = next(
        (place for place, cell in enumerate(published) if not cell.is_given or cell.is_validation),
        len(published),
    )
    waiting = dict.fromkeys(place for place, cell in enumerate(published) if cell.is_given)
    merged, own = list[Cell](), list[Part]()

    def run(those: Sequence[int]) -> None:
        merged.extend(_taken(cells[part.of], lines[part.of], part) for part in own)
        own.clear()
        merged.extend(_cell(published[place]) for place in those)
        for place in those:
            waiting.pop(place, None)

    run(range(first))
    for at, (part, cell) in enumerate(zip(parts, taken, strict=True)):
        copy = copies.get(at)
        place = published.index(copy) if copy else places.get(cell.id, -1)
        run(
            [one for one in waiting if one < place and published[one] not in last]
            if copy is None or last[copy] == at
            else []
        )
        edited = copy is None or _text(cell.source) != _text(copy.source)
        if edited and own and (own[-1].of, own[-1].end) == (part.of, part.first):
            own[-1] = own[-1]._replace(end=part.end)
        elif edited:
            own.append(part)
        if copy is not None and last[copy] == at and (edited or place in waiting):
            run([place])
    run(list(waiting))
    return tuple(merged)


def _all_parts(lines: Sequence[list[str]], given: Sequence[PublishedCell]) -> list[Part]:
    """Return the parts of all cells, at most MOST_PARTS besides the cells themselves."""
    validations = [_lines(one.source.strip()) for one in given if one.is_validation]
    validations.sort(key=lambda one: sum(map(len, one)), reverse=True)
    found = list[Part]()
    for at, of_cell in enumerate(lines):
        parts = list(_parts(at, of_cell, validations))
        padded = sum(part.first for part in parts) <= MOST_PADDING // len(lines)
        split = padded and len(found) + len(parts) <= MOST_PARTS + at + 1
        found += parts if split else [Part(at, 0, len(of_cell))]
    return found


def _parts(at: int, lines: list[str], validations: Sequence[list[str]]) -> Iterator[Part]:
    """Yield a student's cell in parts: one for each validation cell whose lines it contains, and for each
    cell of a Python file.
    """
    places, covered, bounds = defaultdict[str, list[int]](list), bytearray(len(lines)), {0, len(lines)}
    for number, line in enumerate(lines):
        places[line].append(number)
    for one in validations:
        for first in places.get(one[0], ()):
            end = first + len(one)
            if len(bounds) < MOST_PIECES and lines[first:end] == one and not any(covered[first:end]):
                covered[first:end] = bytes([1]) * len(one)
                bounds |= {first, end}
    marks = [number for number, line in enumerate(lines) if MARK.match(line) and not covered[number]]
    if len(marks) < MOST_PIECES:
        bounds |= set(marks)
    yield from (Part(at, *pair) for pair in pairwise(sorted(bounds)))


def _taken(whole: Cell, lines: list[str], part: Part) -> Cell:
    """Return a part of a cell as one, whose lines have the numbers that they have in the ``whole``."""
    if (part.first, part.end) == (0, len(lines)):
        return whole
    return Cell(whole.name, "\n" * part.first + "\n".join(lines[part.first : part.end]))


def _copies(cells: Sequence[Cell], given: Sequence[PublishedCell]) -> dict[int, PublishedCell]:
    """Return the published cell of each student's cell that is a copy, by its index."""
    by_text, by_id = defaultdict[str, list[PublishedCell]](list), {cell.id: cell for cell in given if cell.id}
    for one in given:
        by_text[_text(one.source)].append(one)
    found, alike = dict[int, PublishedCell](), defaultdict[str, list[int]](list)
    for at, cell in enumerate(cells):
        if (text := _text(cell.source)) in by_text:
            alike[text].append(at)
    for text, places in alike.items():
        same = by_text[text]
        with_id = {at: by_id[cells[at].id] for at in places if by_id.get(cells[at].id) in same}
        left = [one for one in same if one not in with_id.values()]
        others = [at for at in places if at not in with_id]
        in_order = dict(zip(reversed(others), reversed(left), strict=False))
        found |= with_id | in_order | {at: same[0] for at in others if at not in in_order}
    found |= {at: by_id[cell.id] for at, cell in enumerate(cells) if at not in found and cell.id in by_id}
    return dict(sorted((found | _edited(cells, given, found)).items()))


def _edited(
    cells: Sequence[Cell], given: Sequence[PublishedCell], found: dict[int, PublishedCell]
) -> dict[int, PublishedCell]:
    """Return the published cells of edited copies: of each that is not ``found`` the most similar one."""
    known = set(found.values())
    left = [(one, _pairs(one.source)) for one in given if one not in known]
    edited = dict[int, PublishedCell]()
    for at, cell in enumerate(cells):
        if at in found or not left:
            continue
        own = _pairs(cell.source)
        likeness = [_likeness(own, theirs) for _, theirs in left]
        if max(likeness) >= ALIKE:
            edited[at], _ = left.pop(likeness.index(max(likeness)))
    return edited


def _pairs(source: str) -> Counter[tuple[str, str]]:
    """Count the pairs of words and signs that follow each other in a text."""
    return Counter(pairwise(["", *WORD.findall(source), ""]))


def _likeness(one: Counter[tuple[str, str]], other: Counter[tuple[str, str]]) -> float:
    """Return the share of the pairs of two texts that both have, from 0 to 1, or 0 if their lengths show that
    it is too small.
    """
    both = one.total() + other.total()
    if 2 * min(one.total(), other.total()) < ALIKE * both:
        return 0.0
    return 2 * sum(min(count, one[pair]) for pair, count in other.items() if pair in one) / both


def _lines(source: str) -> list[str]:
    return [line.rstrip() for line in source.split("\n")]


def _text(source: str) -> str:
    return "\n".join(_lines(IS_BROUGHT.sub("", source.strip())))


def _cell(published: PublishedCell) -> Cell:
    return Cell(published.name, published.source, published=True)
