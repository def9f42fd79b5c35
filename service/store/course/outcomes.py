"""Read the checks of counted submissions: by student, by check, by cause, or those that match a filter.

A class has tens of thousands of outcomes, so PostgreSQL aggregates them to a row per student, check or cause.
It joins short words to a text, which Python splits faster than psycopg reads an array. ``gradings`` are those
of the counted submissions with a report. An override counts instead of the measured state.
"""

from collections.abc import Mapping, Sequence
from uuid import UUID

from service.store.database import Database, Row

# The outcomes ``cell`` of these gradings; ``shown`` is the state that counts: with an override, passed if it
# gives all points.
_CELL = """
WITH cell AS (
    SELECT v.grading_id, v.check_id, v.state, v.counted, v.margin, v.codes, v.causes,
    o.points IS NOT NULL AS overridden,
        CASE WHEN o.points IS NULL THEN v.state WHEN o.points >= v.points THEN 'pass' ELSE 'fail' END AS shown
    FROM outcome v JOIN grading a ON a.id = v.grading_id
        LEFT JOIN override o ON o.submission_id = a.submission_id AND o.check_id = v.check_id
        AND o.withdrawn_at IS NULL
    WHERE v.grading_id = ANY(CAST(%(gradings)s AS uuid[]))
)
"""

_BY_STUDENT = f"""{_CELL}
SELECT grading_id, string_agg(check_id, ' ') AS checks,
    string_agg(shown || CASE WHEN overridden THEN '*' ELSE '' END, ' ') AS states
FROM cell WHERE counted GROUP BY grading_id
"""

_BY_CHECK = f"""{_CELL}
SELECT check_id, string_agg(shown, ' ') AS states, array_agg(margin) FILTER (WHERE margin > 0) AS margins,
    array_agg(causes[1]) FILTER (WHERE shown <> 'pass' AND causes <> '{{}}') AS causes,
    count(*) FILTER (WHERE state = 'pass' AND margin IS NULL) AS exact,
    min(margin) FILTER (WHERE state = 'pass') AS smallest
FROM cell WHERE counted GROUP BY check_id
"""

_BY_CAUSE = f"""{_CELL}
SELECT code, sentence, count(DISTINCT grading_id) AS students, count(DISTINCT check_id) AS checks,
    array_agg(DISTINCT check_id) AS check_ids
FROM cell, unnest(codes, causes) AS cause(code, sentence)
WHERE shown <> 'pass' GROUP BY code, sentence ORDER BY students DESC, code COLLATE "C", sentence COLLATE "C"
"""

_MATCHING = f"""{_CELL}
SELECT grading_id, check_id AS check, shown, CASE WHEN shown <> 'pass' THEN causes[1] END AS cause FROM cell
WHERE (CAST(%(check)s AS text) IS NULL OR check_id = %(check)s AND counted)
    AND (CAST(%(state)s AS text) IS NULL OR shown = %(state)s OR %(state)s = 'not-pass' AND shown <> 'pass')
    AND (CAST(%(cause)s AS text) IS NULL OR shown <> 'pass' AND %(cause)s = ANY(causes))
ORDER BY check_id
"""


async def by_student(database: Database, gradings: Sequence[UUID]) -> dict[UUID | None, dict[str, str]]:
    """Return by grading and check id the state that counts; that of an override ends with "*"."""
    rows = await database.rows(_BY_STUDENT, {"gradings": gradings})
    return {row.grading_id: dict(zip(row.checks.split(), row.states.split(), strict=True)) for row in rows}


async def by_check(database: Database, gradings: Sequence[UUID]) -> Mapping[str, Row]:
    """Return by check id the ``states`` that count, separated by spaces, the positive ``margins`` and the
    first ``causes``.

    These are the causes of those who did not pass. ``exact`` is the number of measured passes without a
    margin, ``smallest`` the smallest margin of the others.
    """
    return {row.check_id: row for row in await database.rows(_BY_CHECK, {"gradings": gradings})}


async def by_cause(database: Database, gradings: Sequence[UUID]) -> Sequence[Row]:
    """Return a row per diagnosis, the most common first: ``code``, ``sentence``, the numbers of
    ``students`` and ``checks``, and the ``check_ids``.
    """
    return await database.rows(_BY_CAUSE, {"gradings": gradings})


async def matching(
    database: Database, gradings: Sequence[UUID], check: str | None, state: str | None, cause: str | None
) -> dict[UUID, list[Row]]:
    """Return by grading its outcomes of this check, state and cause, None meaning any: ``check``, ``shown``
    and first ``cause``.

    The state "not-pass" is any but "pass". A passed check has no cause.
    """
    found: dict[UUID, list[Row]] = {}
    values = {"gradings": gradings, "check": check, "state": state, "cause": cause}
    for row in await database.rows(_MATCHING, values):
        found.setdefault(row.grading_id, []).append(row)
    return found
