"""Read submissions with the result shown for each."""

import hashlib
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from uuid import UUID

from polhode.report.dataclass_json import read as read_document
from polhode.report.report import Report
from service.formats.grade_row import after_penalty
from service.grading.submission import Submission
from service.store.database import Database, Row


@dataclass(frozen=True)
class NewSubmission:
    """A submission to be stored; ``arrived`` is its request's time in seconds of the monotonic clock."""

    id: UUID
    assignment: str
    person: str
    submission: Submission
    seed: int
    arrived: float = field(default_factory=time.monotonic)

    @property
    def fingerprint(self) -> str:
        """Return a hash of the content, which is the same for a repeated request."""
        given = self.submission
        parts = [self.assignment, given.filename, given.source, repr(given.exercises)]
        return hashlib.sha256("\x00".join(parts).encode()).hexdigest()


@dataclass(frozen=True)
class SubmissionRecord:
    """A submission as accepted, with the result shown for it, if any: a report or a system fault.

    ``grading`` is the grading shown: the last one with a report, else the last one. ``status`` is "queued",
    "running", "graded" or "faulted". ``cancelled_by`` names the staff member who cancelled it. ``points``
    is the score after overrides, from which the late ``penalty`` is taken. ``scores_released`` and
    ``details_released`` say whether the student may see the scores and the details of hidden checks;
    ``withheld``, that report and points were left out because they may not.
    """

    id: UUID
    assignment: str
    person: str
    submission: Submission
    submitted_at: datetime
    late: bool
    grading: UUID
    number: int
    seed: int
    report: Report | None
    fault: str | None
    status: str
    cancelled_by: str | None = None
    points: float | None = None
    full_name: str = ""
    penalty: float = 0
    scores_released: bool = True
    details_released: bool = True
    withheld: bool = False

    @property
    def finished(self) -> bool:
        """Return whether the submission has a result."""
        return self.status in ("graded", "faulted")

    @property
    def final(self) -> float | None:
        """Return the points after the late penalty, None without points."""
        return after_penalty(self.points, self.penalty)


def points(given: str, grading: str, score: str) -> str:
    """Return a lateral subquery, named by ``given``, with the ``points`` of a grading of submission ``s``
    after overrides, and whether any override is in force, ``overridden``. An override from before the check
    lost counts at most what the check is worth. Few submissions have an override, so points are only added up
    for these.
    """
    overridden = "EXISTS (SELECT FROM override o WHERE o.submission_id = s.id AND o.withdrawn_at IS NULL)"
    return f"""LATERAL (
    SELECT {overridden} AS overridden, CASE WHEN {overridden} THEN (
        SELECT coalesce(max(o.points) FILTER (WHERE o.check_id IS NULL),
            {score} + coalesce(sum(least(o.points, v.points) - v.earned), 0))
        FROM override o LEFT JOIN outcome v ON v.grading_id = {grading} AND v.check_id = o.check_id
        AND v.counted
        WHERE o.submission_id = s.id AND o.withdrawn_at IS NULL
    ) ELSE {score} END AS points
) {given} ON true"""


# The grading shown is the last one with a report or, without any report, the last one. So a regrade in
# progress does not hide the former report. Preview gradings are never shown.
SHOWN = f"""
LATERAL (
    SELECT a.id AS grading, a.number, a.seed, r.fault, r.cancelled_by, r.score, r.max_score, r.report,
        CAST(r.report->>'total' AS int) AS total,
        r.grading_id IS NOT NULL AS finished, r.finished_at, r.version
    FROM grading a LEFT JOIN result r ON r.grading_id = a.id
    WHERE a.submission_id = s.id AND NOT a.preview ORDER BY r.score IS NOT NULL DESC, a.number DESC LIMIT 1
) shown ON true
LEFT JOIN {points("given", "shown.grading", "shown.score")}
"""

# The submissions ``s`` of assignment ``slug`` and person ``person``, each of which may be null for all,
# with the grading shown as in SHOWN. Joins of whole tables: a lateral join would look up each of a class's
# thousands of submissions.
EACH_SHOWN = """(
    SELECT DISTINCT ON (s.id) s.id, s.assignment_id, s.person_id, s.filename, s.submitted_at, s.late,
    a.id AS grading, r.fault,
        r.score, r.max_score, r.grading_id IS NOT NULL AS finished, r.finished_at, r.version
    FROM submission s JOIN grading a ON a.submission_id = s.id AND NOT a.preview
    LEFT JOIN result r ON r.grading_id = a.id
    WHERE (CAST(%(slug)s AS text) IS NULL
            OR s.assignment_id = (SELECT id FROM assignment WHERE slug = %(slug)s))
        AND (CAST(%(person)s AS text) IS NULL
            OR s.person_id = (SELECT id FROM person WHERE name = %(person)s))
    ORDER BY s.id, r.score IS NOT NULL DESC, a.number DESC
) s"""

# The last grading with its result, if it has one. Preview gradings do not count.
LAST = """
LATERAL (SELECT * FROM grading WHERE submission_id = s.id AND NOT preview ORDER BY number DESC
    LIMIT 1) a ON true
    JOIN result r ON r.grading_id = a.id
"""


def status(shown: str) -> str:
    """Return an expression with the status of the grading shown, a row named by ``shown``."""
    return f"""CASE WHEN {shown}.fault IS NOT NULL THEN 'faulted' WHEN {shown}.finished THEN 'graded'
    WHEN EXISTS (SELECT FROM run WHERE run.grading_id = {shown}.grading AND ended_at IS NULL) THEN 'running'
    ELSE 'queued' END AS status"""


STATUS = status("shown")

# A later deadline, for everyone or for one person, clears lateness; an earlier one never adds it.
_IS_LATE = """(s.late AND coalesce(s.submitted_at > greatest(x.due_at, (
    SELECT e.due_at FROM extension e WHERE e.assignment_id = x.id AND e.person_id = s.person_id
    AND x.due_at IS NOT NULL
)), false))"""
LATE = f"{_IS_LATE} AS late"

# The points ``cut.penalty`` that submission ``s`` to assignment ``x`` loses for being late: of its points
# after overrides a share for each day or part of a day after the person's deadline, up to the limit. None if
# it is not late or not graded.
PENALTY = f"""LATERAL (
    SELECT CASE WHEN {_IS_LATE} THEN (
        SELECT round(given.points * CAST(least(k.late_penalty_limit, k.late_penalty * ceil(extract(epoch
        FROM s.submitted_at
            - greatest(x.due_at, (SELECT e.due_at FROM extension e WHERE e.assignment_id = x.id
            AND e.person_id = s.person_id))
        ) / 86400)) AS numeric), 2)
        FROM course k WHERE k.id = x.course_id
    ) END AS penalty
) cut ON true"""

# Points after the late penalty.
FINAL = "given.points - coalesce(cut.penalty, 0)"


def _released(what: str) -> str:
    return f"""CASE x.{what}_release WHEN 'immediately' THEN true
    WHEN 'manually' THEN x.{what}_released_at IS NOT NULL
    ELSE coalesce(now() > greatest(x.due_at, (
        SELECT e.due_at FROM extension e WHERE e.assignment_id = x.id AND e.person_id = s.person_id
    )) + make_interval(secs => x.grace_s), false) END AS {what}_released"""


# Whether the student who sent submission ``s`` may see its scores, and the details of its hidden checks: at
# the deadline means once their own deadline and the grace period are over.
SCORES_RELEASED, DETAILS_RELEASED = _released("scores"), _released("details")

# The deadline ``until.due_at`` of assignment ``x`` with a person's extension ``e``. Without a deadline an
# extension means nothing.
OWN_DEADLINE = (
    "(SELECT CASE WHEN x.due_at IS NOT NULL THEN greatest(x.due_at, e.due_at) END AS due_at) until ON true"
)

# Whether every grading of submission ``s`` ended in a system fault: it does not use up a submission.
FAULTED = """(SELECT bool_and(r.fault IS NOT NULL) FROM grading a LEFT JOIN result r ON r.grading_id = a.id
    WHERE a.submission_id = s.id AND NOT a.preview)"""

_ONE = f"""
SELECT s.id, x.slug AS assignment, p.name AS person, p.full_name, s.source, s.filename, s.exercises,
    s.submitted_at,
    {LATE}, shown.*, given.points, coalesce(cut.penalty, 0) AS penalty, {SCORES_RELEASED}, {DETAILS_RELEASED},
    {STATUS}
FROM submission s JOIN assignment x ON x.id = s.assignment_id JOIN person p ON p.id = s.person_id JOIN {SHOWN}
    LEFT JOIN {PENALTY}
WHERE s.id = %(id)s
"""

_LIST = f"""
SELECT s.id, s.filename, p.name AS person, p.full_name, s.submitted_at, {LATE}, shown.score, shown.max_score,
    shown.total,
    given.points, given.overridden, coalesce(cut.penalty, 0) AS penalty, {SCORES_RELEASED}, {STATUS},
    x.slug AS assignment
FROM submission s JOIN person p ON p.id = s.person_id JOIN assignment x ON x.id = s.assignment_id JOIN {SHOWN}
    LEFT JOIN {PENALTY}
WHERE coalesce(p.name = CAST(%(person)s AS text), true)
    AND coalesce(starts_with(CAST(s.id AS text), CAST(%(text)s AS text))
    OR strpos(lower(s.filename), CAST(%(text)s AS text)) > 0, true)
ORDER BY s.submitted_at DESC LIMIT %(most)s
"""

_STATE = f"""
SELECT s.id, shown.finished, shown.score, shown.max_score, shown.total, shown.grading, shown.number,
    going.phase, going.scene,
    going.scenes, {STATUS}
FROM submission s JOIN {SHOWN} LEFT JOIN LATERAL (
    SELECT phase, scene, scenes FROM run
    WHERE run.grading_id = shown.grading AND NOT shown.finished AND ended_at IS NULL ORDER BY started_at DESC
    LIMIT 1
) going ON true
WHERE s.id = %(id)s
"""

_POSITIONS = """
SELECT args->>'attempt' AS grading, row_number() OVER (ORDER BY priority DESC, id) AS position
FROM procrastinate_jobs WHERE status = 'todo' AND task_name = 'grade'
"""


async def read(database: Database, id: UUID) -> SubmissionRecord | None:
    """Return the submission with that id, or None."""
    row = await database.first(_ONE, {"id": id})
    return None if row is None else _stored(row)


async def recent(
    database: Database, most: int, person: str | None = None, text: str | None = None
) -> Sequence[Row]:
    """Return the latest ``most`` submissions, of everyone or of one person, newest first.

    With ``text``, in lower case, only those whose id begins with it or whose file name contains it.

    ``score``, ``max_score``, ``points`` and ``total`` are None without a report.
    """
    return await database.rows(_LIST, {"most": most, "person": person, "text": text})


async def state(database: Database, id: UUID) -> Row | None:
    """Return status, scores, ``grading`` and progress of a submission as a row, or None."""
    return await database.first(_STATE, {"id": id})


async def positions(database: Database) -> Mapping[str, int]:
    """Return the position in the queue by grading id; the next one to start has position 1."""
    return {row.grading: row.position for row in await database.rows(_POSITIONS)}


def _stored(row: Row) -> SubmissionRecord:
    return SubmissionRecord(
        id=row.id,
        assignment=row.assignment,
        person=row.person,
        submission=Submission(row.source, row.filename, row.exercises),
        submitted_at=row.submitted_at,
        late=row.late,
        grading=row.grading,
        number=row.number,
        seed=row.seed,
        report=None if row.report is None else read_document(Report, row.report),
        fault=row.fault,
        status=row.status,
        cancelled_by=row.cancelled_by,
        points=row.points,
        full_name=row.full_name,
        penalty=row.penalty,
        scores_released=row.scores_released,
        details_released=row.details_released,
    )
