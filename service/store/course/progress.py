"""Read how the class and each student get on: medians of the assignments, and a student's own standing."""

from collections.abc import Mapping

from service.store.course.grades import SENT
from service.store.database import Database, Row
from service.store.people.people import COURSE
from service.store.submissions.records import FAULTED, OWN_DEADLINE, SHOWN, STATUS

_MEDIANS = f"""
SELECT x.slug, percentile_cont(0.5) WITHIN GROUP (ORDER BY best.final) AS median FROM (
    SELECT assignment_id, person_id, max(final) AS final FROM ({SENT}) sent GROUP BY 1, 2
) best JOIN assignment x ON x.id = best.assignment_id JOIN member m ON m.person_id = best.person_id
    AND m.course_id = x.course_id
WHERE m.role = 'student' GROUP BY x.slug
"""

_OWN = f"""
SELECT x.slug, x.weight, x.grace_s, x.submission_limit, until.due_at,
    coalesce(until.due_at > x.due_at, false) AS extended,
    coalesce(now() > until.due_at + make_interval(secs => x.grace_s), false) AS over, last.status,
    (SELECT count(*) FROM submission s WHERE s.person_id = p.id AND s.assignment_id = x.id
    AND NOT {FAULTED}) AS used
FROM assignment x JOIN course c ON c.id = x.course_id LEFT JOIN person p ON p.name = %(name)s
    LEFT JOIN extension e ON e.assignment_id = x.id AND e.person_id = p.id
    JOIN LATERAL {OWN_DEADLINE}
    LEFT JOIN LATERAL (
        SELECT {STATUS} FROM submission s JOIN {SHOWN}
        WHERE s.assignment_id = x.id AND s.person_id = p.id ORDER BY s.submitted_at DESC LIMIT 1
    ) last ON true
WHERE c.slug = %(course)s
"""


async def medians(database: Database) -> Mapping[str, float | None]:
    """Return by assignment the median over the students who submitted of their best points after the late
    penalty.

    It is None without a graded submission.
    """
    return {row.slug: row.median for row in await database.rows(_MEDIANS, {"slug": None, "person": None})}


async def own(database: Database, name: str) -> Mapping[str, Row]:
    """Return by assignment a person's own rules, as ``deadlines.own`` does, and the status of their last
    submission.
    """
    return {row.slug: row for row in await database.rows(_OWN, {"name": name, "course": COURSE})}
