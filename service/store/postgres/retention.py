"""Delete stored files that polhode can make again: drawn figures, files of replaced gradings, and arrays.

Submissions, gradings, reports, outcomes and scores are never deleted.
"""

from collections.abc import Iterator, Mapping
from typing import NamedTuple
from uuid import UUID

import psycopg
from psycopg.types.json import Jsonb

BATCH = 1000  # gradings in one transaction
FIRST = UUID(int=0)


class Prunable(NamedTuple):
    """Stored files of one kind ("replaced", "drawn" or "arrays"), and the space in bytes that their contents
    take: what several files have in common counts once, also if files that stay have it.
    """

    kind: str
    files: int
    size: int


def prune(
    url: str, versions: Mapping[str, str], *, days: float, arrays: bool, delete: bool
) -> list[Prunable]:
    """Return the files that can be made again, of results older than ``days``, and delete them if ``delete``.

    * "replaced": all files of a grading that is not shown, as a later grading has a report, or the regrade
      was dropped;
    * "drawn": figures and motions that the next request draws again, of reports by the assignment's current
      version (``versions``, by slug);
    * "arrays", in place of "drawn" if ``arrays``: what the student's functions returned. Figures that were
      not drawn before then need a regrade.
    """
    found = {kind: [0, 0] for kind in ("replaced", "arrays" if arrays else "drawn")}
    counted = set[str]()
    with psycopg.connect(url, autocommit=True) as connection:
        for gradings in _batches(connection):
            values = {"gradings": gradings, "days": days, "arrays": arrays, "versions": Jsonb(dict(versions))}
            with connection.transaction():
                if delete:
                    # none may be stored again meanwhile
                    connection.execute("LOCK TABLE artefact IN SHARE ROW EXCLUSIVE MODE")
                rows = connection.execute(_PRUNABLE, values).fetchall()
                if delete and rows:
                    _delete(connection, [row[:2] for row in rows])
            for _, _, kind, size, content in rows:
                found[kind][0] += 1
                found[kind][1] += size if content not in counted else 0
                counted.add(content)
    return [Prunable(kind, *numbers) for kind, numbers in found.items()]


def _batches(connection: psycopg.Connection) -> Iterator[list[UUID]]:
    """Yield the ids of all gradings."""
    last = FIRST
    while ids := [row[0] for row in connection.execute(_NEXT, {"last": last, "batch": BATCH}).fetchall()]:
        yield ids
        last = ids[-1]


def _delete(connection: psycopg.Connection, files: list[tuple[UUID, str]]) -> None:
    """Delete files of gradings, and the contents that no grading has any more."""
    gradings, names = [grading for grading, _ in files], [name for _, name in files]
    if pruned := [grading for grading, name in files if name == "arrays.npz"]:
        connection.execute(_MARK, {"gradings": pruned})
    deleted = connection.execute(_DELETE, {"gradings": gradings, "names": names}).fetchall()
    connection.execute(_DELETE_CONTENTS, {"contents": [row[0] for row in deleted]})


_NEXT = "SELECT id FROM grading WHERE id > %(last)s ORDER BY id LIMIT %(batch)s"

_PRUNABLE = """
SELECT * FROM (
    SELECT k.grading_id, k.name, CASE
        WHEN g.id <> shown.id AND (NOT g.preview OR y.decided IS NOT NULL)
            AND k.name <> 'pruned' THEN 'replaced'
        WHEN g.id = shown.id AND k.name = 'arrays.npz' AND %(arrays)s THEN 'arrays'
        WHEN g.id = shown.id AND (k.name LIKE 'figures/%%' OR k.name LIKE 'motions/%%') AND NOT %(arrays)s
            AND r.version = CAST(%(versions)s AS jsonb)->>x.slug
            AND EXISTS (SELECT 1 FROM grading_artefact WHERE grading_id = g.id
            AND name = 'arrays.npz') THEN 'drawn'
        END AS kind, pg_column_size(a.content) AS size, a.sha256
    FROM grading_artefact k JOIN artefact a USING (sha256)
        JOIN grading g ON g.id = k.grading_id JOIN result r ON r.grading_id = g.id
        JOIN submission s ON s.id = g.submission_id JOIN assignment x ON x.id = s.assignment_id
        LEFT JOIN regrade y ON y.id = g.regrade_id
        JOIN LATERAL (
            SELECT b.id FROM grading b JOIN result o ON o.grading_id = b.id
            WHERE b.submission_id = s.id AND NOT b.preview AND o.report IS NOT NULL ORDER BY b.number DESC
            LIMIT 1
        ) shown ON true
    WHERE g.id = ANY(%(gradings)s) AND r.finished_at <= now() - make_interval(
        secs => 86400 * CAST(%(days)s AS float8))
) files WHERE kind IS NOT NULL
"""

# `polhode db check` misses the arrays of no grading with this mark.
_MARK = """
WITH stored AS (INSERT INTO artefact (sha256, content) VALUES (encode(sha256(''), 'hex'), '')
    ON CONFLICT DO NOTHING)
INSERT INTO grading_artefact (grading_id, name, sha256)
SELECT id, 'pruned', encode(sha256(''), 'hex') FROM unnest(CAST(%(gradings)s AS uuid[])) id
    ON CONFLICT DO NOTHING
"""

_DELETE = """
DELETE FROM grading_artefact k USING unnest(CAST(%(gradings)s AS uuid[]),
    CAST(%(names)s AS text[])) one (grading, name)
WHERE k.grading_id = one.grading AND k.name = one.name RETURNING k.sha256
"""

_DELETE_CONTENTS = """
DELETE FROM artefact a WHERE sha256 = ANY(%(contents)s) AND NOT EXISTS (SELECT 1 FROM grading_artefact
    WHERE sha256 = a.sha256)
"""
