"""Store and find artefacts of gradings: arrays, figures, contact sheets and sweeps. Equal content is stored
once.
"""

from collections.abc import Mapping
from hashlib import sha256
from uuid import UUID

from service.store.database import Connection, Database

ARTEFACTS = """
SELECT a.content, a.sha256 FROM grading_artefact k JOIN artefact a USING (sha256)
WHERE k.grading_id = ANY(CAST(%(gradings)s AS uuid[])) AND k.name = %(name)s
"""

# In the order of the hashes, which avoids deadlocks.
_INSERT = """
WITH given AS (
    SELECT * FROM unnest(CAST(%(names)s AS text[]), CAST(%(marks)s AS text[]),
    CAST(%(contents)s AS bytea[])) one (name, sha256, content)
), stored AS (
    INSERT INTO artefact (sha256, content) SELECT sha256, content FROM given ORDER BY sha256
    ON CONFLICT DO NOTHING
)
INSERT INTO grading_artefact (grading_id, name, sha256) SELECT %(grading)s, name, sha256 FROM given
ON CONFLICT DO NOTHING
"""


async def find_artefact(database: Database, grading: UUID, name: str) -> tuple[bytes, str] | None:
    """Return content and SHA-256 (hexadecimal) of a grading's artefact, or None."""
    row = await database.first(ARTEFACTS, {"gradings": [grading], "name": name})
    return None if row is None else (row.content, row.sha256)


async def store_artefacts(database: Database, grading: UUID, artefacts: Mapping[str, bytes]) -> None:
    """Store artefacts made after the grading, such as a figure drawn on the first request."""
    async with database.begin() as connection:
        await insert_artefacts(connection, grading, artefacts)


async def insert_artefacts(connection: Connection, grading: UUID, artefacts: Mapping[str, bytes]) -> None:
    """Store artefacts in this transaction; content that several gradings have is stored once."""
    marks = [sha256(content).hexdigest() for content in artefacts.values()]
    given = {"names": [*artefacts], "marks": marks, "contents": [*artefacts.values()]}
    await connection.execute(_INSERT, {"grading": grading, **given})
