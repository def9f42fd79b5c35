"""The gradebook of an assignment: each student's counted submission with its outcomes.

The submission with the most points after the late penalty counts; of equal ones, the newest.
"""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime
from typing import NamedTuple
from uuid import UUID

from service.store.course.grades import BEST
from service.store.course.people import COURSE, IS_PERSON
from service.store.database import Database, Row


class Cell(NamedTuple):
    """The outcome of one check worth ``points``; ``given`` are the points of an override.

    ``causes`` holds the code and the sentence of each diagnosis.
    """

    state: str
    counted: bool
    margin: float | None
    points: int = 1
    given: float | None = None
    causes: tuple[tuple[str, str], ...] = ()

    @property
    def shown(self) -> str:
        """Return the state that counts: with an override, passed if it gives all points."""
        return self.state if self.given is None else "pass" if self.given >= self.points else "fail"


@dataclass(frozen=True)
class StudentRow:
    """A student with their counted submission, if any, and its cells by check id."""

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
    points: float | None
    penalty: float
    final: float | None
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
    """Return all students of the course, by name, including those without a submission."""
    found = await students(database, slug)
    values = {"gradings": [s.grading for s in found if s.score is not None]}  # the others may be graded between the queries
    cells = {row.grading_id: _cells(row) for row in await database.rows(_CELLS, values)}
    for row in await database.rows(_MORE, values):
        of_grading = cells[row.grading_id]
        of_grading[row.check_id] = of_grading[row.check_id]._replace(
            given=row.points, causes=tuple(zip(row.codes, row.causes, strict=True))
        )
    return [replace(s, cells=cells[s.grading]) if s.grading in cells else s for s in found]


def _cells(row: Row) -> dict[str, Cell]:
    cells = zip(row.states, row.counted, row.margins, row.points, strict=True)
    return dict(zip(row.checks, itertools.starmap(Cell, cells), strict=True))


async def students(database: Database, slug: str) -> list[StudentRow]:
    """Return all students of the course, by name, with their counted submissions but without cells."""
    rows = await database.rows(_STANDINGS, {"slug": slug, "person": None, "course": COURSE})
    return [StudentRow(**row._asdict()) for row in rows]


async def overview(database: Database) -> Sequence[Row]:
    """Return a row per assignment: rules, numbers of students and submissions, and open work for the staff.

    The earliest deadline is first; assignments without one follow.
    """
    return await database.rows(_OVERVIEW, {"course": COURSE, "slug": None})


async def rules(database: Database, slug: str) -> Row:
    """Return one assignment's overview row."""
    return await database.one(_OVERVIEW, {"course": COURSE, "slug": slug})


_STANDINGS = f"""
WITH best AS MATERIALIZED ({BEST})
SELECT p.name, p.full_name, p.email, p.student_id, coalesce(best.submissions, 0) AS submissions, best.id AS submission,
    best.filename, best.submitted_at,
    best.finished_at, coalesce(best.late, false) AS late, coalesce(best.status, 'no submission') AS status,
    best.score, best.points,
    coalesce(best.penalty, 0) AS penalty, best.final, best.max_score, coalesce(best.overridden, false) AS overridden,
    best.version, best.grading
FROM member m JOIN course c ON c.id = m.course_id JOIN person p ON p.id = m.person_id LEFT JOIN best ON best.person_id = p.id
WHERE c.slug = :course AND m.role = 'student' AND {IS_PERSON}
ORDER BY lower(coalesce(nullif(p.full_name, ''), p.name)), p.name
"""

# One row per student rather than per check, as a class has tens of thousands of outcomes.
_CELLS = """
SELECT grading_id, array_agg(check_id) AS checks, array_agg(state) AS states, array_agg(counted) AS counted,
    array_agg(margin) AS margins, array_agg(points) AS points
FROM outcome WHERE grading_id = ANY(CAST(:gradings AS uuid[])) GROUP BY grading_id
"""

_MORE = """
SELECT v.grading_id, v.check_id, v.codes, v.causes, o.points
FROM outcome v JOIN grading a ON a.id = v.grading_id
    LEFT JOIN override o ON o.submission_id = a.submission_id AND o.check_id = v.check_id AND o.withdrawn_at IS NULL
WHERE v.grading_id = ANY(CAST(:gradings AS uuid[])) AND (v.state <> 'pass' AND v.causes <> '{}' OR o.points IS NOT NULL)
"""

_OVERVIEW = f"""
SELECT x.slug, x.due_at, x.grace_s, x.submission_limit, x.weight, x.scores_release, x.scores_released_at, x.details_release,
    x.details_released_at, coalesce(class.students, 0) AS students,
    coalesce(sent.people, 0) AS submitted, coalesce(sent.submissions, 0) AS submissions, coalesce(sent.open, 0) AS open,
    coalesce(sent.faults, 0) AS faults, (
        SELECT count(*) FROM regrade r WHERE r.assignment_id = x.id AND r.decided IS NULL) AS regrades, (
        SELECT count(*) FROM regrade_request q JOIN submission s ON s.id = q.submission_id
        WHERE s.assignment_id = x.id AND q.status = 'open') AS requests
FROM assignment x JOIN course c ON c.id = x.course_id
    LEFT JOIN (SELECT m.course_id, count(*) AS students FROM member m JOIN person p ON p.id = m.person_id
        WHERE m.role = 'student' AND {IS_PERSON} GROUP BY 1) class
        ON class.course_id = c.id
    LEFT JOIN (
        SELECT s.assignment_id, count(*) AS submissions, count(DISTINCT s.person_id) FILTER (WHERE m.role = 'student') AS people,
            count(*) FILTER (WHERE state.open) AS open, count(*) FILTER (WHERE NOT state.open AND state.fault) AS faults
        FROM submission s LEFT JOIN member m ON m.person_id = s.person_id
            JOIN LATERAL (SELECT coalesce(bool_or(r.grading_id IS NULL), false) AS open, bool_and(r.fault IS NOT NULL) AS fault
                FROM grading a LEFT JOIN result r ON r.grading_id = a.id
                WHERE a.submission_id = s.id AND NOT a.preview) state ON true
        WHERE CAST(:slug AS text) IS NULL OR s.assignment_id IN (SELECT id FROM assignment WHERE slug = :slug)
        GROUP BY s.assignment_id
    ) sent ON sent.assignment_id = x.id
WHERE c.slug = :course AND coalesce(x.slug = CAST(:slug AS text), true) ORDER BY x.due_at, x.slug
"""
