"""The gradebook of an assignment: each student's counted submission.

The submission with the most points after the late penalty counts; of equal ones, the newest.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from uuid import UUID

from service.store.course import assignment_settings
from service.store.course.grades import SENT, best
from service.store.database import Database, Row
from service.store.people.people import COURSE, IS_PERSON


@dataclass(frozen=True)
class StudentRow:
    """A student with their counted submission, if any.

    ``sent_at`` and ``earned`` have the times and the points before the late penalty, None if not graded, of
    all their submissions, oldest first.
    """

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
    sent_at: Sequence[datetime] = ()
    earned: Sequence[float | None] = ()

    @property
    def display_name(self) -> str:
        """The full name, or the login name without one."""
        return self.full_name or self.name


async def students(database: Database, slug: str) -> list[StudentRow]:
    """Return all students of the course, by name, including those without a submission."""
    rows = await database.rows(_STANDINGS, {"slug": slug, "person": None, "course": COURSE})
    return [StudentRow(**row._asdict()) for row in rows]


def beside(students: Sequence[StudentRow], name: str) -> tuple[StudentRow | None, StudentRow | None]:
    """Return those before and after the student of that ``name`` who submitted something, None at the ends
    and for somebody who is not a student.
    """
    submitted = [s for s in students if s.submission is not None]
    at = next((k for k, s in enumerate(submitted) if s.name == name), None)
    if at is None:
        return None, None
    around = [None, *submitted, None]
    return around[at], around[at + 2]


def graded(students: Iterable[StudentRow]) -> list[UUID]:
    """Return the gradings of the counted submissions with a report."""
    return [s.grading for s in students if s.grading is not None and s.score is not None]


async def overview(database: Database) -> Sequence[Row]:
    """Return a row per assignment: rules, numbers of students and submissions, and open work for the staff.

    The earliest deadline is first; assignments without one follow.
    """
    return await database.rows(_OVERVIEW, {"course": COURSE, "slug": None})


async def rules(database: Database, slug: str) -> Row:
    """Return one assignment's overview row."""
    return await database.one(_OVERVIEW, {"course": COURSE, "slug": slug})


async def medians(database: Database) -> Mapping[str, float | None]:
    """Return by assignment the median over the students who submitted of their best points after the late
    penalty.

    It is None without a graded submission.
    """
    return {row.slug: row.median for row in await database.rows(_MEDIANS, {"slug": None, "person": None})}


_STANDINGS = f"""
WITH sent AS MATERIALIZED ({SENT}), best AS MATERIALIZED ({best("sent")}), history AS (
    SELECT person_id, array_agg(submitted_at ORDER BY submitted_at) AS sent_at,
        array_agg(CAST(points AS float8) ORDER BY submitted_at) AS earned
    FROM sent GROUP BY person_id)
SELECT p.name, p.full_name, p.email, p.student_id, coalesce(best.submissions, 0) AS submissions,
    best.id AS submission,
    best.filename, best.submitted_at,
    best.finished_at, coalesce(best.late, false) AS late, coalesce(best.status, 'no submission') AS status,
    best.score, best.points,
    coalesce(best.penalty, 0) AS penalty, best.final, best.max_score,
    coalesce(best.overridden, false) AS overridden,
    best.version, best.grading, coalesce(history.sent_at, '{{}}') AS sent_at,
    coalesce(history.earned, '{{}}') AS earned
FROM member m JOIN course c ON c.id = m.course_id JOIN person p ON p.id = m.person_id
    LEFT JOIN best ON best.person_id = p.id
    LEFT JOIN history ON history.person_id = p.id
WHERE c.slug = %(course)s AND m.role = 'student' AND {IS_PERSON}
ORDER BY p.sort_key, p.name
"""

_OVERVIEW = f"""
SELECT x.slug, {", ".join(f"x.{name}" for name in assignment_settings.NAMES)},
    x.scores_released_at, x.details_released_at,
    x.published AND coalesce(x.available_from <= now(), true) AS available,
    coalesce(class.students, 0) AS students,
    coalesce(sent.people, 0) AS submitted, coalesce(sent.submissions, 0) AS submissions,
    coalesce(sent.open, 0) AS open,
    coalesce(sent.faults, 0) AS faults, (
        SELECT count(*) FROM regrade r WHERE r.assignment_id = x.id AND r.decided IS NULL) AS regrades, (
        SELECT count(*) FROM regrade_request q JOIN submission s ON s.id = q.submission_id
        WHERE s.assignment_id = x.id AND q.status = 'open') AS requests
FROM assignment x JOIN course c ON c.id = x.course_id
    LEFT JOIN (SELECT m.course_id, count(*) AS students FROM member m JOIN person p ON p.id = m.person_id
        WHERE m.role = 'student' AND {IS_PERSON} GROUP BY 1) class
        ON class.course_id = c.id
    LEFT JOIN (
        SELECT s.assignment_id, count(*) AS submissions,
        count(DISTINCT s.person_id) FILTER (WHERE m.role = 'student') AS people,
            count(*) FILTER (WHERE s.open) AS open, count(*) FILTER (WHERE NOT s.open AND s.fault) AS faults
        FROM (
            SELECT s.assignment_id, s.person_id, bool_or(r.grading_id IS NULL) AS open,
            bool_and(r.fault IS NOT NULL) AS fault
            FROM submission s JOIN grading a ON a.submission_id = s.id AND NOT a.preview
            LEFT JOIN result r ON r.grading_id = a.id
            WHERE CAST(%(slug)s AS text) IS NULL OR s.assignment_id = (SELECT id FROM assignment
            WHERE slug = %(slug)s)
            GROUP BY s.id
        ) s LEFT JOIN member m ON m.person_id = s.person_id
        GROUP BY s.assignment_id
    ) sent ON sent.assignment_id = x.id
WHERE c.slug = %(course)s AND coalesce(x.slug = CAST(%(slug)s AS text), true) ORDER BY x.due_at, x.slug
"""

_MEDIANS = f"""
SELECT x.slug, percentile_cont(0.5) WITHIN GROUP (ORDER BY best.final) AS median FROM (
    SELECT assignment_id, person_id, max(final) AS final FROM ({SENT}) sent GROUP BY 1, 2
) best JOIN assignment x ON x.id = best.assignment_id JOIN member m ON m.person_id = best.person_id
    AND m.course_id = x.course_id
WHERE m.role = 'student' GROUP BY x.slug
"""
