"""Read a person's past submissions to an assignment, and the gradings of one submission."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from uuid import UUID

from service.formats.grade_row import after_penalty
from service.store.database import Database, Row
from service.store.submissions.records import FINAL, LATE, PENALTY, SCORES_RELEASED, SHOWN, STATUS

MOST = 100


@dataclass(frozen=True)
class PastSubmission:
    """A person's submission; ``verdicts`` by check id are those of the report shown, if any.

    ``comments`` is the number of comments on its source; ``regrade_request`` the status of the last request,
    if any.
    """

    id: UUID
    filename: str
    submitted_at: datetime
    late: bool
    source: str
    sha256: str
    status: str
    score: int | None
    max_score: int | None
    total: int | None
    points: float | None
    penalty: float
    scores_released: bool
    verdicts: dict[str, str]
    comments: int
    regrade_request: str | None

    @property
    def final(self) -> float | None:
        """The points after the late penalty."""
        return after_penalty(self.points, self.penalty)


async def timeline(database: Database, person: str, slug: str) -> Sequence[Row]:
    """Return the person's latest MOST submissions to an assignment, newest first, without their sources.

    ``points``, and ``final`` after the late penalty, are None without a report; ``before`` is the id of the
    preceding submission.
    """
    return await database.rows(_TIMELINE, {"person": person, "slug": slug, "most": MOST})


async def previous(database: Database, submission: UUID) -> UUID | None:
    """Return the id of the same person's preceding submission to the same assignment, or None."""
    row = await database.first(_BEFORE, {"submission": submission})
    return None if row is None else row.id


async def gradings(database: Database, submission: UUID) -> Sequence[Row]:
    """Return all gradings of a submission, oldest first, with result and with start and worker of the run
    that produced it.

    ``kind`` is "interactive", "regrade" or "bulk"; ``runs`` counts all runs started. A ``preview`` grading
    belongs to a regrade that has not been applied.
    """
    return await database.rows(_GRADINGS, {"submission": submission})


async def past_submissions(database: Database, person: str, slug: str) -> Sequence[PastSubmission]:
    """Return the person's latest MOST submissions to an assignment, newest first,
    with source and verdicts.
    """
    rows = await database.rows(_PAST, {"person": person, "slug": slug, "most": MOST})
    return [PastSubmission(**{**row._asdict(), "verdicts": row.verdicts or {}}) for row in rows]


_PAST = f"""
SELECT s.id, s.filename, s.submitted_at, {LATE}, s.source, s.sha256, shown.score, shown.max_score,
    shown.total,
    given.points, coalesce(cut.penalty, 0) AS penalty, {SCORES_RELEASED}, {STATUS}, (
    SELECT jsonb_object_agg(o->>'id', o->>'verdict')
    FROM jsonb_array_elements(shown.report->'exercises') e, jsonb_array_elements(e->'outcomes') o
) AS verdicts,
    (SELECT count(*) FROM source_comment c WHERE c.submission_id = s.id) AS comments,
    (SELECT q.status FROM regrade_request q WHERE q.submission_id = s.id ORDER BY requested_at DESC
    LIMIT 1) AS regrade_request
FROM submission s JOIN assignment x ON x.id = s.assignment_id JOIN person p ON p.id = s.person_id JOIN {SHOWN}
    LEFT JOIN {PENALTY}
WHERE p.name = %(person)s AND x.slug = %(slug)s ORDER BY s.submitted_at DESC LIMIT %(most)s
"""

_TIMELINE = f"""
WITH s AS (
    SELECT s.*, lag(s.id) OVER (ORDER BY s.submitted_at, s.id) AS before
    FROM submission s JOIN assignment x ON x.id = s.assignment_id JOIN person p ON p.id = s.person_id
    WHERE p.name = %(person)s AND x.slug = %(slug)s ORDER BY s.submitted_at DESC, s.id DESC LIMIT %(most)s
)
SELECT s.id, s.filename, s.submitted_at, {LATE}, given.points, {FINAL} AS final, shown.max_score,
    shown.total, {SCORES_RELEASED}, {STATUS}, s.before
FROM s JOIN assignment x ON x.id = s.assignment_id JOIN {SHOWN} LEFT JOIN {PENALTY}
ORDER BY s.submitted_at DESC, s.id DESC
"""

_BEFORE = """
SELECT b.id FROM submission s JOIN submission b USING (person_id, assignment_id)
WHERE s.id = %(submission)s AND (b.submitted_at, b.id) < (s.submitted_at, s.id)
    ORDER BY b.submitted_at DESC, b.id DESC LIMIT 1
"""

_GRADINGS = """
SELECT a.number, a.kind, a.preview, a.requested_at, r.started_at, r.worker,
    (SELECT count(*) FROM run WHERE grading_id = a.id) AS runs,
    v.finished_at, v.score, CAST(v.report->>'total' AS int) AS total, v.version,
    v.fault, v.cancelled_by
FROM grading a LEFT JOIN result v ON v.grading_id = a.id LEFT JOIN LATERAL (
    SELECT started_at, worker FROM run WHERE run.grading_id = a.id AND coalesce(run.id = v.run_id, true)
    ORDER BY started_at DESC LIMIT 1
) r ON true
WHERE a.submission_id = %(submission)s ORDER BY a.number
"""
