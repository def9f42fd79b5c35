"""Store and find artefacts of gradings: arrays, figures, contact sheets and sweeps. Equal content is stored
once.
"""

from collections.abc import Mapping
from hashlib import sha256
from typing import Any
from uuid import UUID

from service.grading.result import SHARED
from service.store.database import Connection, Database

ARTEFACTS = """
SELECT a.content, a.sha256 FROM grading_artefact k JOIN artefact a USING (sha256)
WHERE k.grading_id = ANY(CAST(:gradings AS uuid[])) AND k.name = :name
"""

# The arrays of a grading if its own are still stored.
_ARRAYS = f"""
SELECT a.content FROM grading_artefact own JOIN grading_artefact k USING (grading_id)
    JOIN artefact a ON a.sha256 = k.sha256
WHERE own.grading_id = :grading AND own.name = 'arrays.npz' AND (k.name = 'arrays.npz'
    OR starts_with(k.name, '{SHARED}'))
"""

# Returns the names of those ``shared`` whose content is stored already. In the order of their hashes, which
# avoids deadlocks.
_INSERT = """
WITH given AS (
    SELECT * FROM unnest(CAST(:names AS text[]), CAST(:marks AS text[]),
    CAST(:contents AS bytea[])) one (name, sha256, content)
), stored AS (
    INSERT INTO artefact (sha256, content) SELECT sha256, content FROM given ORDER BY sha256
    ON CONFLICT DO NOTHING
), own AS (
    INSERT INTO grading_artefact (grading_id, name, sha256) SELECT :grading, name, sha256 FROM given
    ON CONFLICT DO NOTHING
)
INSERT INTO grading_artefact (grading_id, name, sha256)
SELECT :grading, name, sha256 FROM unnest(CAST(:shared AS text[]), CAST(:shared_marks AS text[]))
    one (name, sha256)
    JOIN artefact USING (sha256)
ON CONFLICT DO NOTHING RETURNING name
"""


async def find_artefact(database: Database, grading: UUID, name: str) -> tuple[bytes, str] | None:
    """Return content and SHA-256 (hexadecimal) of a grading's artefact, or None."""
    row = await database.first(ARTEFACTS, {"gradings": [grading], "name": name})
    return None if row is None else (row.content, row.sha256)


async def store_artefacts(database: Database, grading: UUID, artefacts: Mapping[str, bytes]) -> None:
    """Store artefacts made after the grading, such as a figure drawn on the first request."""
    async with database.begin() as connection:
        await insert_artefacts(connection, grading, artefacts)


async def find_arrays(database: Database, grading: UUID) -> list[bytes]:
    """Return the files with a grading's arrays, or an empty list if they have been deleted."""
    return [row.content for row in await database.rows(_ARRAYS, {"grading": grading})]


async def insert_artefacts(connection: Connection, grading: UUID, artefacts: Mapping[str, bytes]) -> None:
    """Store artefacts in this transaction; content that several gradings have is stored once. Content whose
    name begins with SHARED is sent only if it is not stored yet.
    """
    own, shared = dict[str, bytes](), dict[str, bytes]()
    for name, content in artefacts.items():
        (shared if name.startswith(SHARED) else own)[name] = content
    linked = await connection.rows(_INSERT, _values(grading, own, shared))
    if missing := shared.keys() - {row.name for row in linked}:
        await connection.rows(_INSERT, _values(grading, {name: shared[name] for name in missing}, {}))


def _values(grading: UUID, own: Mapping[str, bytes], shared: Mapping[str, bytes]) -> dict[str, Any]:
    marks, shared_marks = (
        [sha256(content).hexdigest() for content in files.values()] for files in (own, shared)
    )
    return {
        "grading": grading,
        "names": [*own],
        "marks": marks,
        "contents": [*own.values()],
        "shared": [*shared],
        "shared_marks": shared_marks,
    }
