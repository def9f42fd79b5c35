"""A person's submissions to an assignment with what became of each: what a student looks back on."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from uuid import UUID

from service.store.database import Database
from service.store.reading import LATE, SHOWN, STATUS

MOST = 100


@dataclass(frozen=True)
class Past:
    """A submission of theirs; ``verdicts`` by check are those of the report shown for it, empty without one."""

    id: UUID
    filename: str
    submitted_at: datetime
    late: bool
    source: str
    sha256: str
    status: str
    score: int | None
    max_score: int | None
    points: int | None
    verdicts: dict[str, str]


async def past(database: Database, person: str, slug: str) -> Sequence[Past]:
    """The latest MOST of them, newest first."""
    rows = await database.rows(_PAST, {"person": person, "slug": slug, "most": MOST})
    return [Past(**{**row._mapping, "verdicts": row.verdicts or {}}) for row in rows]


_PAST = f"""
SELECT s.id, s.filename, s.submitted_at, {LATE}, s.source, s.sha256, shown.score, shown.max_score, given.points, {STATUS}, (
    SELECT jsonb_object_agg(o->>'id', o->>'verdict')
    FROM jsonb_array_elements(shown.report->'exercises') e, jsonb_array_elements(e->'outcomes') o
) AS verdicts
FROM submission s JOIN assignment x ON x.id = s.assignment_id JOIN person p ON p.id = s.person_id JOIN {SHOWN}
WHERE p.name = :person AND x.slug = :slug ORDER BY s.submitted_at DESC LIMIT :most
"""
