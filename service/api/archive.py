"""Zip archive of all data of an assignment, streamed in batches so that it never is in memory as a
whole.
"""

import asyncio
import json
from collections.abc import AsyncIterator, Iterable, Mapping, Sequence
from contextlib import closing
from datetime import UTC, datetime

from polhode.report.dataclass_json import read as read_document
from polhode.report.report import Report
from service.formats.filenames import UniqueNames, safe_filename
from service.formats.grade_row import moment
from service.formats.spreadsheet_csv import BYTE_ORDER_MARK, Value, table
from service.formats.zip_stream import ZipStream
from service.store.course.grades import overrides, submissions, trail
from service.store.database import Database, Row
from service.store.people.people import ROSTER

AUDIT = ("at", "who", "action", "subject", "detail")
OVERRIDES = (
    "student",
    "submission_id",
    "check_id",
    "points",
    "reason",
    "given_by",
    "given_at",
    "withdrawn_by",
    "withdrawn_at",
)
INDEX = (
    "student", "submission", "submitted_at", "late", "status", "attempt", "points", "score", "counted",
    "overridden", "fault",
    "sha256", "folder", "penalty",
)  # fmt: skip
RESERVED_NAMES = ("report.json", "report.txt")


async def course_archive(
    database: Database, slug: str, files: Mapping[str, str], people: Sequence[Row], *, everything: bool = True
) -> AsyncIterator[bytes]:
    """Yield the zip's bytes: ``files``, every submission with its report, and their index.

    With ``everything`` it also holds roster, overrides and audit log.
    """
    top, now = safe_filename(slug), datetime.now(UTC)
    with closing(ZipStream()) as archive:
        tables = dict(files)
        if everything:
            overridden = await overrides(database, slug)
            tables |= {"roster.csv": _lines(ROSTER, people), "overrides.csv": _lines(OVERRIDES, overridden)}
        for name, content in tables.items():
            archive.add(f"{top}/{name}", content, now)
        if everything:
            number = 0
            async for entries in trail(database):
                number += 1
                archive.add(f"{top}/audit/{number:04}.csv", _lines(AUDIT, entries), now)
                yield archive.take()
        folders = Folders(top, [person.name for person in people])
        async for batch in submissions(database, slug):
            await asyncio.to_thread(folders.add, archive, batch)
            yield archive.take()
        archive.add(f"{top}/submissions.csv", BYTE_ORDER_MARK + table(INDEX, folders.index), now)
        yield archive.end()


class Folders:
    """Folders of the archive: one per person, with one per submission.

    ``index`` has one row per submission.
    """

    def __init__(self, top: str, people: Iterable[str]) -> None:
        self._top, self._names = top, UniqueNames()
        self._folders = {name: self._names.give(name, "person") for name in people}
        self.index: list[list[Value]] = []

    def add(self, archive: ZipStream, batch: Sequence[Row]) -> None:
        """Add a batch of submissions to the archive."""
        for row in batch:
            person = self._folders.get(row.person) or self._folders.setdefault(
                row.person, self._names.give(row.person, "person")
            )
            folder = (
                f"{self._top}/submissions/{person}/{row.submitted_at.astimezone(UTC):%Y%m%dT%H%M%SZ}-{row.id}"
            )
            archive.add(
                f"{folder}/{UniqueNames(RESERVED_NAMES).give(row.filename, 'submission.py')}",
                row.source,
                row.submitted_at,
            )
            for name, content in _reports(row).items():
                archive.add(f"{folder}/{name}", content, row.submitted_at)
            self.index.append(_line(row, folder))


def _reports(row: Row) -> dict[str, str]:
    """Return the report as JSON and as text."""
    if row.report is None:
        return {}
    return {
        "report.json": json.dumps(row.report, ensure_ascii=False, indent=1),
        "report.txt": read_document(Report, row.report).text(),
    }


def _line(row: Row, folder: str) -> list[Value]:
    result = [row.number, row.points, row.score, row.max_score, row.overridden, row.fault]
    return [
        row.person,
        str(row.id),
        moment(row.submitted_at),
        row.late,
        row.status,
        *result,
        row.sha256,
        folder,
        row.penalty,
    ]


def _lines(columns: Sequence[str], rows: Sequence[Row]) -> str:
    return BYTE_ORDER_MARK + table(
        columns, [[_value(getattr(row, name)) for name in columns] for row in rows]
    )


def _value(value: object) -> Value:
    if isinstance(value, datetime):
        return moment(value)
    return value if value is None or isinstance(value, int | float | str) else str(value)
