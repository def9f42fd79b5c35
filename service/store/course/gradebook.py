"""A class at one assignment: where every student stands, each check of the submission that counts, and what waits to be done.

Of a student's submissions the one with the most points counts, of equals the newest.
"""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime
from typing import Any, NamedTuple
from uuid import UUID

from sqlalchemy import Row

from service.store.course.grades import BEST, SOMEBODY
from service.store.course.people import COURSE
from service.store.database import Database


class Cell(NamedTuple):
    """What became of one check: a key of ``states.MARKS``; ``given`` are the points an instructor set instead. ``causes`` are
    codes and sentences."""

    state: str
    counted: bool
    margin: float | None
    given: int | None = None
    causes: tuple[tuple[str, str], ...] = ()

    @property
    def shown(self) -> str:
        """The state as it counts: that of an override, if there is one."""
        return self.state if self.given is None else "pass" if self.given else "fail"


@dataclass(frozen=True)
class StudentRow:
    """A student with the submission that counts, if there is one, and its cells by check."""

    name: str
    full_name: str
    email: str
    student_id: str
    submissions: int
    submission: UUID | None
    grading: UUID | None
    filename: str | None
    submitted_at: datetime | None
    finished_at: datetime | None
    late: bool
    status: str
    score: int | None
    points: int | None
    max_score: int | None
    overridden: bool
    version: str | None
    cells: Mapping[str, Cell] = field(default_factory=dict)

    @property
    def display_name(self) -> str:
        """The full name, or the login name without one."""
        return self.full_name or self.name

    def matching_cells(self, check: str | None, cause: str | None) -> list[tuple[str, Cell, str]]:
        """Return the cell of ``check``, or without it the cells with ``cause``; each with its check id and first cause."""
        if check is not None:
            found = {check: self.cells[check]} if check in self.cells else {}
        else:
            wrong = {id: c for id, c in self.cells.items() if c.shown != "pass"}
            found = {id: c for id, c in wrong.items() if any(sentence == cause for _, sentence in c.causes)}
        return [(id, c, c.causes[0][1] if c.causes and c.shown != "pass" else "") for id, c in found.items()]


async def student_rows(database: Database, slug: str) -> list[StudentRow]:
    """Every student of the course, by name, also those who sent nothing."""
    found = await students(database, slug)
    values = {"gradings": [s.grading for s in found if s.score is not None]}  # others may get their outcomes between two queries
    cells = {row.grading_id: _cells(row) for row in await database.rows(_CELLS, values)}
    for row in await database.rows(_MORE, values):
        own = cells[row.grading_id]
        own[row.check_id] = own[row.check_id]._replace(given=row.points, causes=tuple(zip(row.codes, row.causes, strict=True)))
    return [replace(s, cells=cells[s.grading]) if s.grading in cells else s for s in found]


def _cells(row: Row[Any]) -> dict[str, Cell]:
    cells = zip(row.states, row.counted, row.margins, strict=True)
    return dict(zip(row.checks, itertools.starmap(Cell, cells), strict=True))


async def students(database: Database, slug: str) -> list[StudentRow]:
    """The same without cells."""
    rows = await database.rows(_STANDINGS, {"slug": slug, "course": COURSE})
    return [StudentRow(**row._mapping) for row in rows]


async def overview(database: Database) -> Sequence[Row[Any]]:
    """The assignments with their rules, how many students there are and have submitted, and what waits for somebody."""
    return await database.rows(_OVERVIEW, {"course": COURSE})


async def rules(database: Database, slug: str) -> Row[Any]:
    """One of these."""
    return next(row for row in await overview(database) if row.slug == slug)


_STANDINGS = f"""
WITH best AS MATERIALIZED ({BEST})
SELECT p.name, p.full_name, p.email, p.student_id, coalesce(best.submissions, 0) AS submissions, best.id AS submission,
    best.filename, best.submitted_at,
    best.finished_at, coalesce(best.late, false) AS late, coalesce(best.status, 'no submission') AS status,
    best.score, best.points, best.max_score, coalesce(best.overridden, false) AS overridden, best.version, best.grading
FROM member m JOIN course c ON c.id = m.course_id JOIN person p ON p.id = m.person_id LEFT JOIN best ON best.person_id = p.id
WHERE c.slug = :course AND m.role = 'student' AND {SOMEBODY}
ORDER BY lower(coalesce(nullif(p.full_name, ''), p.name)), p.name
"""

# A row for every student rather than for every check: a class has tens of thousands of these.
_CELLS = """
SELECT grading_id, array_agg(check_id) AS checks, array_agg(state) AS states, array_agg(counted) AS counted,
    array_agg(margin) AS margins
FROM outcome WHERE grading_id = ANY(CAST(:gradings AS uuid[])) GROUP BY grading_id
"""

_MORE = """
SELECT v.grading_id, v.check_id, v.codes, v.causes, o.points
FROM outcome v JOIN grading a ON a.id = v.grading_id
    LEFT JOIN override o ON o.submission_id = a.submission_id AND o.check_id = v.check_id AND o.withdrawn_at IS NULL
WHERE v.grading_id = ANY(CAST(:gradings AS uuid[])) AND (v.state <> 'pass' AND v.causes <> '{}' OR o.points IS NOT NULL)
"""

_OVERVIEW = f"""
SELECT x.slug, x.due_at, x.grace_s, x.submission_limit, coalesce(class.students, 0) AS students,
    coalesce(sent.people, 0) AS submitted, coalesce(sent.submissions, 0) AS submissions, coalesce(sent.open, 0) AS open,
    coalesce(sent.faults, 0) AS faults, (
        SELECT count(*) FROM regrade r WHERE r.assignment_id = x.id AND r.decided IS NULL) AS regrades
FROM assignment x JOIN course c ON c.id = x.course_id
    LEFT JOIN (SELECT m.course_id, count(*) AS students FROM member m JOIN person p ON p.id = m.person_id
        WHERE m.role = 'student' AND {SOMEBODY} GROUP BY 1) class
        ON class.course_id = c.id
    LEFT JOIN (
        SELECT s.assignment_id, count(*) AS submissions, count(DISTINCT s.person_id) FILTER (WHERE m.role = 'student') AS people,
            count(*) FILTER (WHERE state.open) AS open, count(*) FILTER (WHERE NOT state.open AND state.fault) AS faults
        FROM submission s LEFT JOIN member m ON m.person_id = s.person_id
            JOIN LATERAL (SELECT coalesce(bool_or(r.grading_id IS NULL), false) AS open, bool_and(r.fault IS NOT NULL) AS fault
                FROM grading a LEFT JOIN result r ON r.grading_id = a.id
                WHERE a.submission_id = s.id AND NOT a.preview) state ON true
        GROUP BY s.assignment_id
    ) sent ON sent.assignment_id = x.id
WHERE c.slug = :course ORDER BY x.slug
"""
