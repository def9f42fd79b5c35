"""The audit trail as it is read: who did what to whom, newest first."""

from collections.abc import Sequence
from typing import Any

from sqlalchemy import Row

from service.store.database import Database

MOST = 200


async def entries(database: Database, subject: str | None = None, before: int | None = None) -> Sequence[Row[Any]]:
    """The latest MOST entries, of all or about one subject or person, and with ``before`` those older than the entry of that id."""
    return await database.rows(_TRAIL, {"subject": subject, "before": before})


_TRAIL = f"""
SELECT id, at, actor, action, subject, detail FROM audit
WHERE (CAST(:subject AS text) IS NULL OR CAST(:subject AS text) IN (subject, actor, detail->>'person'))
    AND id < coalesce(CAST(:before AS bigint), 9223372036854775807)
ORDER BY id DESC LIMIT {MOST}
"""
