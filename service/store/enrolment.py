"""Which workers are there, and what they grade behind or why they cannot."""

from sqlalchemy import text

from service.store.database import Database


async def enrol(database: Database, worker: str, walls: str | None, refusal: str | None, zygotes: int = 0) -> None:
    """Tell that a worker is there and what it grades behind, or why it cannot grade."""
    values = {"name": worker, "walls": walls, "refusal": refusal, "zygotes": zygotes}
    async with database.begin() as connection:
        await connection.execute(_ENROL, values)


async def leave(database: Database, worker: str) -> None:
    """Tell that a worker is not there any more."""
    async with database.begin() as connection:
        await connection.execute(text("DELETE FROM worker WHERE name = :name"), {"name": worker})


_ENROL = text("""
INSERT INTO worker (name, walls, refusal, zygotes) VALUES (:name, :walls, :refusal, :zygotes)
ON CONFLICT (name) DO UPDATE SET walls = :walls, refusal = :refusal, zygotes = :zygotes, seen_at = now()
""")
