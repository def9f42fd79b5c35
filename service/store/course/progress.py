"""Read how the class and each student get on: every submission's points over time, medians, and a student's own standing."""

from collections.abc import Mapping, Sequence

from service.store.course.people import COURSE
from service.store.database import Database, Row
from service.store.records import FAULTED, FINAL, OWN_DEADLINE, PENALTY, SHOWN, STATUS, points

# Every submission with its grading shown and its points, before and after the late penalty. Joins of whole tables: a class has
# thousands of submissions.
_POINTS = f"""
SELECT s.id, s.assignment_id, s.person_id, s.submitted_at, s.grading, given.points, {FINAL} AS final FROM (
    SELECT DISTINCT ON (s.id) s.id, s.assignment_id, s.person_id, s.submitted_at, s.late, a.id AS grading,
        r.score
    FROM submission s JOIN grading a ON a.submission_id = s.id AND NOT a.preview LEFT JOIN result r ON r.grading_id = a.id
    WHERE CAST(:slug AS text) IS NULL OR s.assignment_id = (
        SELECT x.id FROM assignment x JOIN course c ON c.id = x.course_id WHERE x.slug = :slug AND c.slug = :course)
    ORDER BY s.id, r.score IS NOT NULL DESC, a.number DESC
) s JOIN assignment x ON x.id = s.assignment_id LEFT JOIN {points("given", "s.grading", "s.score")} LEFT JOIN {PENALTY}
"""

_OF_CLASS = f"""
SELECT p.name, sent.submitted_at, sent.points
FROM ({_POINTS}) sent JOIN assignment x ON x.id = sent.assignment_id JOIN person p ON p.id = sent.person_id
    JOIN member m ON m.person_id = p.id AND m.course_id = x.course_id AND m.role = 'student'
ORDER BY sent.submitted_at
"""

_MEDIANS = f"""
SELECT x.slug, percentile_cont(0.5) WITHIN GROUP (ORDER BY best.final) AS median FROM (
    SELECT assignment_id, person_id, max(final) AS final FROM ({_POINTS}) sent GROUP BY 1, 2
) best JOIN assignment x ON x.id = best.assignment_id JOIN member m ON m.person_id = best.person_id AND m.course_id = x.course_id
WHERE m.role = 'student' GROUP BY x.slug
"""

_OWN = f"""
SELECT x.slug, x.weight, x.grace_s, x.submission_limit, until.due_at, coalesce(until.due_at > x.due_at, false) AS extended,
    coalesce(now() > until.due_at + make_interval(secs => x.grace_s), false) AS over, last.status,
    (SELECT count(*) FROM submission s WHERE s.person_id = p.id AND s.assignment_id = x.id AND NOT {FAULTED}) AS used
FROM assignment x JOIN course c ON c.id = x.course_id LEFT JOIN person p ON p.name = :name
    LEFT JOIN extension e ON e.assignment_id = x.id AND e.person_id = p.id
    JOIN LATERAL {OWN_DEADLINE}
    LEFT JOIN LATERAL (
        SELECT {STATUS} FROM submission s JOIN {SHOWN}
        WHERE s.assignment_id = x.id AND s.person_id = p.id ORDER BY s.submitted_at DESC LIMIT 1
    ) last ON true
WHERE c.slug = :course
"""


async def of_class(database: Database, slug: str) -> Sequence[Row]:
    """Return ``name``, ``submitted_at`` and ``points`` before the late penalty (None: not graded) of every student's submissions,
    oldest first.
    """
    return await database.rows(_OF_CLASS, {"slug": slug, "course": COURSE})


async def medians(database: Database) -> Mapping[str, float | None]:
    """Return by assignment the median over the students who submitted of their best points after the late penalty.

    It is None without a graded submission.
    """
    return {row.slug: row.median for row in await database.rows(_MEDIANS, {"slug": None, "course": COURSE})}


async def own(database: Database, name: str) -> Mapping[str, Row]:
    """Return by assignment a person's own rules, as ``deadlines.own`` does, and the status of their last submission."""
    return {row.slug: row for row in await database.rows(_OWN, {"name": name, "course": COURSE})}
