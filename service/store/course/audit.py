"""Read the audit log."""

from collections.abc import Sequence
from typing import Any

from sqlalchemy import Row

from service.store.database import Database

MOST = 200


async def entries(database: Database, subject: str | None = None, before: int | None = None) -> Sequence[Row[Any]]:
    """Return the latest MOST entries, newest first, of all or one subject, with ids below ``before``."""
    return await database.rows(_ENTRIES, {"subject": subject, "before": before})


_ENTRIES = f"""
SELECT id, at, actor, action, subject, detail FROM audit
WHERE (CAST(:subject AS text) IS NULL OR CAST(:subject AS text) IN (subject, actor, detail->>'person'))
    AND id < coalesce(CAST(:before AS bigint), 9223372036854775807)
ORDER BY id DESC LIMIT {MOST}
"""
