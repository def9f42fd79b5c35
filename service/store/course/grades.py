"""Read grades for export: each student's counted submission with its checks,
and all submissions in batches.
"""

from collections.abc import AsyncIterator, Sequence
from uuid import UUID

from exercises.authoring.assignments.catalogue import assignments
from service.formats.grade_row import GradeRow
from service.store.database import Database, Row
from service.store.people.people import COURSE, IS_PERSON
from service.store.submissions.records import (
    EACH_SHOWN,
    FINAL,
    LATE,
    OWN_DEADLINE,
    PENALTY,
    SCORES_RELEASED,
    SHOWN,
    STATUS,
    points,
    status,
)

BATCH = 25  # submissions with reports: some megabytes at most
AUDIT_BATCH = 2000  # short rows

# Every submission with its points, before and after the late penalty.
SENT = f"""
SELECT s.assignment_id, s.person_id, s.id, s.filename, s.submitted_at, {LATE}, s.grading, s.score,
    s.max_score, s.version,
    s.finished_at, given.points, given.overridden, {status("s")}, coalesce(cut.penalty, 0) AS penalty,
    {FINAL} AS final,
    {SCORES_RELEASED}
FROM {EACH_SHOWN} JOIN assignment x ON x.id = s.assignment_id
    LEFT JOIN {points("given", "s.grading", "s.score")}
    LEFT JOIN {PENALTY}
"""


def best(sent: str) -> str:
    """Return a query of each person's counted submission of those ``sent``: the one with the most points
    after the late penalty.

    Of equal ones, or if none is graded, the newest counts.
    """
    return f"""
SELECT DISTINCT ON (assignment_id, person_id) *, count(*) OVER (PARTITION BY assignment_id,
    person_id) AS submissions FROM {sent}
ORDER BY assignment_id, person_id, final DESC NULLS LAST, submitted_at DESC, id
"""


BEST = best(f"({SENT}) sent")

_GRADES = f"""
WITH best AS MATERIALIZED ({BEST})
SELECT x.slug, x.due_at, x.weight, b.submitted_at - until.due_at AS after_due, p.name, p.full_name, p.email,
    p.student_id,
    b.*, measured.*, overridden.given,
    CASE WHEN %(detailed)s THEN r.report->'provenance'->'versions'->>'polhode' END AS polhode
FROM course c JOIN member m ON m.course_id = c.id JOIN person p ON p.id = m.person_id
    JOIN assignment x ON x.course_id = c.id
    LEFT JOIN best b ON b.assignment_id = x.id AND b.person_id = p.id
    LEFT JOIN result r ON r.grading_id = b.grading LEFT JOIN extension e ON e.assignment_id = x.id
    AND e.person_id = p.id
    JOIN LATERAL {OWN_DEADLINE}
    LEFT JOIN LATERAL (SELECT jsonb_object_agg(v.check_id, v.state) AS checks,
        jsonb_object_agg(v.check_id, v.points) AS worth, jsonb_object_agg(v.check_id, v.earned) AS earned
        FROM outcome v
        WHERE %(detailed)s AND v.grading_id = b.grading) measured ON true
    LEFT JOIN LATERAL (SELECT jsonb_object_agg(o.check_id, o.points) AS given FROM override o
        WHERE %(detailed)s AND o.submission_id = b.id AND o.check_id IS NOT NULL
        AND o.withdrawn_at IS NULL) overridden ON true
WHERE c.slug = %(course)s AND (m.role = 'student' AND CAST(%(person)s AS text) IS NULL OR p.name = %(person)s)
    AND coalesce(x.slug = CAST(%(slug)s AS text), x.published) AND {IS_PERSON}
ORDER BY x.slug, p.sort_key, p.name
"""

_SUBMISSIONS = f"""
SELECT s.id, p.name AS person, s.source, s.sha256, s.filename, s.submitted_at, {LATE}, shown.report,
    shown.number, shown.score,
    shown.max_score, shown.fault, given.points, given.overridden, coalesce(cut.penalty, 0) AS penalty,
    {STATUS}
FROM submission s JOIN assignment x ON x.id = s.assignment_id JOIN person p ON p.id = s.person_id JOIN {SHOWN}
    LEFT JOIN {PENALTY}
WHERE x.slug = %(slug)s AND s.id > %(after)s ORDER BY s.id LIMIT %(most)s
"""

_AUDIT = """
SELECT id, at, actor AS who, action, subject, CAST(detail AS text) AS detail FROM audit
WHERE id > %(after)s ORDER BY id LIMIT %(most)s
"""

_OVERRIDES = """
SELECT p.name AS student, o.submission_id, o.check_id, o.points, o.reason, o.given_by, o.given_at,
    o.withdrawn_by, o.withdrawn_at
FROM override o JOIN submission s ON s.id = o.submission_id JOIN assignment x ON x.id = s.assignment_id
    JOIN person p ON p.id = s.person_id
WHERE x.slug = %(slug)s ORDER BY o.given_at, o.id
"""


async def grades(database: Database, slug: str | None = None, person: str | None = None) -> list[GradeRow]:
    """Return a row per student, or of one person: of one assignment with check states, or of all published
    assignments without.
    """
    values = {"slug": slug, "person": person, "course": COURSE, "detailed": slug is not None}
    most = {slug: assignment.max_points() for slug, assignment in assignments().items()}
    return [_row(found, most.get(found.slug)) for found in await database.rows(_GRADES, values)]


async def submissions(database: Database, slug: str) -> AsyncIterator[Sequence[Row]]:
    """Yield all submissions of an assignment, with source and the report shown, in batches of BATCH."""
    after = UUID(int=0)
    while batch := await database.rows(_SUBMISSIONS, {"slug": slug, "after": after, "most": BATCH}):
        yield batch
        after = batch[-1].id


async def trail(database: Database) -> AsyncIterator[Sequence[Row]]:
    """Yield the audit log from its beginning, in batches of AUDIT_BATCH entries."""
    after = 0
    while batch := await database.rows(_AUDIT, {"after": after, "most": AUDIT_BATCH}):
        yield batch
        after = batch[-1].id


async def overrides(database: Database, slug: str) -> Sequence[Row]:
    """Return all overrides of an assignment, oldest first, including withdrawn ones."""
    return await database.rows(_OVERRIDES, {"slug": slug})


def _row(found: Row, most: int | None) -> GradeRow:
    assignment = assignments().get(found.slug)
    same = {
        name: getattr(found, name)
        for name in ("full_name", "email", "student_id", "submitted_at", "late", "score", "points")
    }
    given = {check: points for check, points in (found.given or {}).items() if check in (found.checks or {})}
    grader = f"polhode {found.polhode}, assignment version {found.version}" if found.polhode else ""
    return GradeRow(
        assignment=found.slug,
        title=assignment.title if assignment else found.slug,
        max_points=found.max_score or 0 if most is None else most,
        student=found.name,
        due_at=found.due_at,
        status=found.status or "none",
        attempts=found.submissions or 0,
        submission=str(found.id) if found.id else None,
        graded_at=found.finished_at if found.score is not None else None,
        counted=found.max_score,
        overridden=bool(found.overridden),
        grader=grader,
        checks=found.checks or {},
        penalty=found.penalty or 0,
        released=found.scores_released is not False,
        weight=found.weight,
        lateness=found.after_due if found.late else None,
        worth=found.worth or {},
        earned=found.earned or {},
        given=given,
        **same,
    )
