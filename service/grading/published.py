"""The published notebook's own cells, run in place of the student's copies."""

import difflib
from collections.abc import Sequence

from exercises.assignment import PublishedCell
from service.sandbox.job import Cell

ALIKE = 0.6  # least similarity of an edited copy to the published cell


def with_published(cells: Sequence[Cell], published: Sequence[PublishedCell]) -> tuple[Cell, ...]:
    """Return the student's ``cells`` with the given ones of the ``published`` notebook in place of their copies.

    A copy has the same id or nearly the same text. An edited copy runs too, before the published cell, because students also write
    their solution there. A published cell without a copy stands before the next one that has one, else at the end.
    """
    waiting = [cell for cell in published if cell.is_given]
    copies, merged = _copies(cells, waiting), list[Cell]()
    for at, cell in enumerate(cells):
        copied = copies.get(at)
        if copied is None:
            merged.append(cell)
            continue
        until = waiting.index(copied) if copied in waiting else 0
        merged += map(_cell, waiting[:until])
        merged += [] if _text(cell.source) == _text(copied.source) else [cell]
        merged += map(_cell, waiting[until : until + 1] if copied in waiting else [])
        waiting = waiting[until + 1 :] if copied in waiting else waiting
    return (*merged, *map(_cell, waiting))


def _copies(cells: Sequence[Cell], given: Sequence[PublishedCell]) -> dict[int, PublishedCell]:
    """Return the published cell of each student's cell that is a copy, by its index."""
    by_text, by_id = {_text(cell.source): cell for cell in given}, {cell.id: cell for cell in given if cell.id}
    found = {at: by_text[text] for at, cell in enumerate(cells) if (text := _text(cell.source)) in by_text}
    found |= {at: by_id[cell.id] for at, cell in enumerate(cells) if at not in found and cell.id in by_id}
    left = [cell for cell in given if cell not in found.values()]
    for at, cell in enumerate(cells):
        if at not in found and left:
            alike = [difflib.SequenceMatcher(None, _text(cell.source), _text(one.source)).ratio() for one in left]
            if max(alike) >= ALIKE:
                found[at] = left.pop(alike.index(max(alike)))
    return found


def _text(source: str) -> str:
    return "\n".join(line.rstrip() for line in source.strip().split("\n"))


def _cell(published: PublishedCell) -> Cell:
    return Cell(published.name, published.source, published=True)
