"""Notes of the staff on a person, which students never see."""

from collections.abc import Sequence
from uuid import UUID

from service.store.course import audit
from service.store.database import Database, Row

LONGEST = 4000


async def write(database: Database, name: str, note: str, author: str) -> None:
    """Add a note on the person."""
    async with database.begin() as connection:
        await connection.execute(_WRITE, {"name": name, "note": note, "author": author})
        await audit.record(connection, author, "note", name, {"note": note})


async def remove(database: Database, name: str, id: UUID, actor: str) -> bool:
    """Remove a note on the person. Return False if there is none with that id."""
    async with database.begin() as connection:
        row = await connection.first(_REMOVE, {"name": name, "id": id})
        if row is not None:
            await audit.record(connection, actor, "note removed", name, {"note": row.note})
    return row is not None


async def of_person(database: Database, name: str) -> Sequence[Row]:
    """Return the notes on the person, newest first: ``id``, ``note``, ``author`` and ``written_at``."""
    return await database.rows(_LIST, {"name": name})


_WRITE = """
INSERT INTO note (person_id, note, author) SELECT id, %(note)s, %(author)s FROM person WHERE name = %(name)s
"""

_REMOVE = (
    "DELETE FROM note n USING person p WHERE p.id = n.person_id AND p.name = %(name)s AND n.id = %(id)s"
    " RETURNING n.note"
)

_LIST = """
SELECT n.id, n.note, n.author, n.written_at FROM note n JOIN person p ON p.id = n.person_id
WHERE p.name = %(name)s ORDER BY n.written_at DESC, n.id
"""
