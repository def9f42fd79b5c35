"""The published notebook's own cells, run in place of the student's copies."""

import difflib
from collections import defaultdict
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

from exercises.assignment import PublishedCell
from service.sandbox.guest.pieces import MARK, MOST_PIECES
from service.sandbox.job import Cell

ALIKE = 0.6  # least similarity of an edited copy to the published cell


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
    parts = [part for at, cell in enumerate(cells) for part in _parts(at, cell, given)]
    taken = [_taken(cells, part) for part in parts]
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
        merged.extend(_taken(cells, part) for part in own)
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


def _parts(at: int, cell: Cell, given: Sequence[PublishedCell]) -> Iterator[Part]:
    """Yield a student's cell in parts: one for each validation cell whose text it contains, and for each cell
    of a Python file.
    """
    lines = _lines(cell.source)
    text, bounds, covered = "\n" + "\n".join(lines) + "\n", {0, len(lines)}, list[tuple[int, int]]()
    for one in sorted((_text(one.source) for one in given if one.is_validation), key=len, reverse=True):
        begin = text.find(f"\n{one}\n")
        while begin >= 0 and len(covered) < MOST_PIECES:
            first = text.count("\n", 0, begin)
            end = first + one.count("\n") + 1
            if all(end <= other or after <= first for other, after in covered):
                covered.append((first, end))
                bounds |= {first, end}
            begin = text.find(f"\n{one}\n", begin + 1)
    marks = {number for number, line in enumerate(lines) if MARK.match(line)}
    if len(marks) < MOST_PIECES:
        bounds |= {number for number in marks if not any(first < number < end for first, end in covered)}
    yield from (Part(at, *pair) for pair in pairwise(sorted(bounds)))


def _taken(cells: Sequence[Cell], part: Part) -> Cell:
    """Return a part as a cell, whose lines have the numbers that they have in the student's."""
    whole, lines = cells[part.of], _lines(cells[part.of].source)
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
        found |= {at: by_id[cells[at].id] for at in places if by_id.get(cells[at].id) in same}
        left = [one for one in same if one not in found.values()]
        others = [at for at in places if at not in found]
        found |= dict(zip(reversed(others), reversed(left), strict=False))
        found |= {at: same[0] for at in others if at not in found}
    found |= {at: by_id[cell.id] for at, cell in enumerate(cells) if at not in found and cell.id in by_id}
    left = [one for one in given if one not in found.values()]
    for at, cell in enumerate(cells):
        if at not in found and left:
            ratios = [_ratio(_text(cell.source), _text(one.source)) for one in left]
            if max(ratios) >= ALIKE:
                found[at] = left.pop(ratios.index(max(ratios)))
    return dict(sorted(found.items()))


def _ratio(text: str, published: str) -> float:
    """Return how alike two texts are, or 0 if the cheap upper bounds show that they are not."""
    matcher = difflib.SequenceMatcher(None, text, published)
    bounds = (matcher.real_quick_ratio, matcher.quick_ratio)
    return matcher.ratio() if all(bound() >= ALIKE for bound in bounds) else 0.0


def _lines(source: str) -> list[str]:
    return [line.rstrip() for line in source.split("\n")]


def _text(source: str) -> str:
    return "\n".join(_lines(source.strip()))


def _cell(published: PublishedCell) -> Cell:
    return Cell(published.name, published.source, published=True)
