"""The cards of the front page: the assignments by what is due next, and the next deadline."""

from collections.abc import Mapping, Sequence
from datetime import UTC, datetime, timedelta

from service.store.database import Row

SOON = timedelta(days=14)
OPEN, LATER, NOT_YET, CLOSED, DRAFT = "Open", "Due later", "Not yet available", "Closed", "Drafts"


def groups(rows: Sequence[Row], own: Mapping[str, Row], order: Sequence[str]) -> dict[str, list[Row]]:
    """Return the assignments by whether they are open, due in more than two weeks, not yet available,
    closed, or drafts; in each group the next deadline first, those without one last, and closed ones latest
    first.

    ``own`` are a student's own rules by assignment, which have their extensions; ``order`` that of the
    catalogue.
    """
    now, found = datetime.now(UTC), dict[str, list[Row]]()
    far = datetime.max.replace(tzinfo=UTC)

    def due(row: Row) -> datetime:
        return due_at(row, own) or far

    for row in sorted(rows, key=lambda row: (due(row), order.index(row.slug))):
        over = due(row) + timedelta(seconds=row.grace_s) < now if due(row) < far else False
        later = now + SOON < due(row) < far
        group = CLOSED if over else NOT_YET if not row.available else LATER if later else OPEN
        found.setdefault(group if row.published else DRAFT, []).append(row)
    if CLOSED in found:
        found[CLOSED].reverse()
    return {name: found[name] for name in (OPEN, LATER, NOT_YET, CLOSED, DRAFT) if name in found}


def due_at(row: Row, own: Mapping[str, Row]) -> datetime | None:
    """Return the deadline of an assignment, the student's own if ``own`` has one."""
    found: datetime | None = own[row.slug].due_at if row.slug in own else row.due_at
    return found


def next_deadline(found: Mapping[str, Sequence[Row]], own: Mapping[str, Row]) -> Row | None:
    """Return the assignment whose deadline is the next, None if no deadline is ahead."""
    ahead = [row for name in (OPEN, LATER) for row in found.get(name, ()) if due_at(row, own)]
    return ahead[0] if ahead else None
