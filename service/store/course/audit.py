"""The audit log: record who did what, and read it."""

from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import Any

from psycopg.types.json import Jsonb

from service.store.database import Connection, Database, Row

MOST = 200
OLD, NEW = "old", "new"
"""The keys of a change in the detail of an entry."""


def changes(before: Mapping[str, Any], after: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Return the old and the new value of each name in ``after`` whose value differs, for an entry."""
    return {
        name: {OLD: _plain(before.get(name)), NEW: _plain(value)}
        for name, value in after.items()
        if value != before.get(name)
    }


def _plain(value: Any) -> Any:
    return value.isoformat() if isinstance(value, datetime) else value


async def record(
    connection: Connection, actor: str, action: str, subject: str, detail: Mapping[str, Any]
) -> None:
    """Add an entry to the audit log: ``actor`` did ``action`` to ``subject``."""
    await connection.execute(
        _RECORD, {"actor": actor, "action": action, "subject": subject, "detail": Jsonb(detail)}
    )


async def entries(database: Database, subject: str | None = None, before: int | None = None) -> Sequence[Row]:
    """Return the latest MOST entries, newest first, of all or one subject, with ids below ``before``."""
    return await database.rows(_ENTRIES, {"subject": subject, "before": before})


_RECORD = """
INSERT INTO audit (actor, action, subject, detail) VALUES (%(actor)s, %(action)s, %(subject)s, %(detail)s)
"""

_ENTRIES = f"""
SELECT id, at, actor, action, subject, detail FROM audit
WHERE (CAST(%(subject)s AS text) IS NULL OR CAST(%(subject)s AS text) IN (subject, actor, detail->>'person'))
    AND id < coalesce(CAST(%(before)s AS bigint), 9223372036854775807)
ORDER BY id DESC LIMIT {MOST}
"""
