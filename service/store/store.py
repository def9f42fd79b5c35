"""Reading and writing submissions, results and artefacts. Every method is one transaction, committed when it returns."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from uuid import UUID

from sqlalchemy import Row, select
from sqlalchemy.dialects.postgresql import insert
from sqlalchemy.ext.asyncio import create_async_engine

from service.grading.report import Report
from service.grading.submission import Submission
from service.store.migrate import driver_url
from service.store.tables import artefact, result, submission


class KeyReused(Exception):
    """An idempotency key came with another body than the first time."""


@dataclass(frozen=True)
class Stored:
    """A submission as accepted, with its result if there is one: a report, or the fault that kept us from making it."""

    id: UUID
    assignment: str
    submission: Submission
    exercises: list[str] | None
    seed: int
    submitted_at: datetime
    report: Report | None = None
    fault: str | None = None

    @property
    def finished(self) -> bool:
        """Whether there is a result."""
        return self.report is not None or self.fault is not None


@dataclass(frozen=True)
class Listed:
    """A submission as a list shows it; ``score`` and ``max_score`` are None where there is no report."""

    id: UUID
    filename: str
    submitted_at: datetime
    finished: bool
    fault: str | None
    score: int | None
    max_score: int | None


class Store:
    """The database behind ``url``; its tables must be up to date."""

    def __init__(self, url: str) -> None:
        self._engine = create_async_engine(driver_url(url), pool_pre_ping=True)

    async def close(self) -> None:
        """Close all connections."""
        await self._engine.dispose()

    async def ping(self) -> None:
        """Raise unless the database answers."""
        async with self._engine.connect() as connection:
            await connection.execute(select(1))

    async def add(self, new: Stored, key: str | None = None) -> Stored:
        """Store a submission; under a known key the one stored before. Raises KeyReused if that one was different."""
        mark = fingerprint(new)
        values = {
            "id": new.id,
            "assignment": new.assignment,
            "source": new.submission.source,
            "filename": new.submission.filename,
            "exercises": new.exercises,
            "seed": new.seed,
            "fingerprint": mark,
            "idempotency_key": key,
        }
        async with self._engine.begin() as connection:
            statement = insert(submission).values(**values).on_conflict_do_nothing(index_elements=["idempotency_key"])
            found = (await connection.execute(statement.returning(submission.c.id, submission.c.fingerprint))).first()
            if found is None:
                known = select(submission.c.id, submission.c.fingerprint).where(submission.c.idempotency_key == key)
                found = (await connection.execute(known)).one()
        if found.fingerprint != mark:
            raise KeyReused
        return await self._read(found.id) or new

    async def get(self, id: UUID) -> Stored | None:
        """The submission of that id, or None."""
        return await self._read(id)

    async def recent(self, most: int) -> Sequence[Listed]:
        """The latest submissions, newest first, without their source and report."""
        columns = [submission.c.id, submission.c.filename, submission.c.submitted_at, result.c.submission_id, result.c.fault]
        numbers = [result.c.report[name].as_integer().label(name) for name in ("score", "max_score")]
        query = select(*columns, *numbers).outerjoin_from(submission, result).order_by(submission.c.submitted_at.desc())
        return [_listed(row) for row in await self._rows(query.limit(most))]

    async def unfinished(self) -> Sequence[UUID]:
        """Ids of submissions without a result, oldest first."""
        query = select(submission.c.id).outerjoin(result).where(result.c.submission_id.is_(None))
        return [row.id for row in await self._rows(query.order_by(submission.c.submitted_at))]

    async def finish(self, id: UUID, report: Report | None, fault: str | None, artefacts: Mapping[str, bytes]) -> None:
        """Write the result and its artefacts together; the first result stays."""
        document = None if report is None else report.model_dump(mode="json")
        async with self._engine.begin() as connection:
            first = insert(result).values(submission_id=id, report=document, fault=fault).on_conflict_do_nothing()
            if (await connection.execute(first.returning(result.c.submission_id))).first() is None:
                return
            for name, content in artefacts.items():
                await connection.execute(insert(artefact).values(_artefact(id, name, content)))

    async def artefact(self, id: UUID, name: str) -> tuple[bytes, str] | None:
        """Content and SHA-256 of an artefact, or None."""
        query = select(artefact.c.content, artefact.c.sha256)
        rows = await self._rows(query.where(artefact.c.submission_id == id, artefact.c.name == name))
        return (rows[0].content, rows[0].sha256) if rows else None

    async def keep(self, id: UUID, name: str, content: bytes) -> None:
        """Keep an artefact made later, such as a figure drawn when somebody looked."""
        async with self._engine.begin() as connection:
            await connection.execute(insert(artefact).values(_artefact(id, name, content)).on_conflict_do_nothing())

    async def _read(self, id: UUID) -> Stored | None:
        rows = await self._rows(_JOINED.where(submission.c.id == id))
        return _stored(rows[0]) if rows else None

    async def _rows(self, query: object) -> Sequence[Row[tuple[object, ...]]]:
        async with self._engine.connect() as connection:
            return (await connection.execute(query)).all()  # type: ignore[call-overload]


_JOINED = select(submission, result.c.report, result.c.fault).outerjoin(result)


def fingerprint(stored: Stored) -> str:
    """What two requests must share to be the same submission."""
    parts = [stored.assignment, stored.submission.filename, stored.submission.source, repr(stored.exercises)]
    return hashlib.sha256("\x00".join(parts).encode()).hexdigest()


def _artefact(id: UUID, name: str, content: bytes) -> dict[str, object]:
    return {"submission_id": id, "name": name, "sha256": hashlib.sha256(content).hexdigest(), "content": content}


def _listed(row: Row[tuple[object, ...]]) -> Listed:
    finished = row.submission_id is not None
    return Listed(row.id, row.filename, row.submitted_at, finished, row.fault, row.score, row.max_score)


def _stored(row: Row[tuple[object, ...]]) -> Stored:
    return Stored(
        id=row.id,
        assignment=row.assignment,
        submission=Submission(row.source, row.filename),
        exercises=row.exercises,
        seed=row.seed,
        submitted_at=row.submitted_at,
        report=None if row.report is None else Report.model_validate(row.report),
        fault=row.fault,
    )
