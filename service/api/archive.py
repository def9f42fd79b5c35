"""The zip with everything of an assignment, made of batches: what was sent is not held any more."""

import asyncio
import json
from collections.abc import AsyncIterator, Iterable, Mapping, Sequence
from contextlib import closing, suppress
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import Row as Found

from ecp.document import NotADocument
from ecp.document import read as read_document
from ecp.report import Report
from service.formats.csv import BYTE_ORDER_MARK, Value, table
from service.formats.filenames import UniqueNames, ZipStream, safe_filename
from service.formats.grade_row import moment
from service.store.course.grades import overrides, submissions, trail
from service.store.course.people import ROSTER
from service.store.database import Database

AUDIT = ("at", "who", "action", "subject", "detail")
GIVEN = ("student", "submission_id", "check_id", "points", "reason", "given_by", "given_at", "withdrawn_by", "withdrawn_at")
INDEX = (
    "student", "submission", "submitted_at", "late", "status", "attempt", "points", "score", "counted", "overridden", "fault",
    "sha256", "folder",
)  # fmt: skip
OURS = ("report.json", "report.txt")


async def course_archive(
    database: Database, slug: str, files: Mapping[str, str], people: Sequence[Found[Any]]
) -> AsyncIterator[bytes]:
    """The zip's bytes: ``files``, the roster, what was given instead, the audit trail, then every submission and a list of them."""
    top, now = safe_filename(slug), datetime.now(UTC)
    with closing(ZipStream()) as archive:
        given = await overrides(database, slug)
        lists = {**files, "roster.csv": _lines(ROSTER, people), "overrides.csv": _lines(GIVEN, given)}
        for name, content in lists.items():
            archive.add(f"{top}/{name}", content, now)
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
    """A folder for each person, in it one for each submission; ``index`` has a line for each of these."""

    def __init__(self, top: str, people: Iterable[str]) -> None:
        self._top, self._names = top, UniqueNames()
        self._of = {name: self._names.give(name, "person") for name in people}
        self.index: list[list[Value]] = []

    def add(self, archive: ZipStream, batch: Sequence[Found[Any]]) -> None:
        """Add these submissions."""
        for found in batch:
            person = self._of.get(found.person) or self._of.setdefault(found.person, self._names.give(found.person, "person"))
            folder = f"{self._top}/submissions/{person}/{found.submitted_at.astimezone(UTC):%Y%m%dT%H%M%SZ}-{found.id}"
            archive.add(f"{folder}/{UniqueNames(OURS).give(found.filename, 'submission.py')}", found.source, found.submitted_at)
            for name, content in _reports(found).items():
                archive.add(f"{folder}/{name}", content, found.submitted_at)
            self.index.append(_line(found, folder))


def _reports(found: Found[Any]) -> dict[str, str]:
    """The report as JSON and as text; one that only an older polhode could read, as JSON alone."""
    if found.report is None:
        return {}
    told = {"report.json": json.dumps(found.report, ensure_ascii=False, indent=1)}
    with suppress(NotADocument):
        told["report.txt"] = read_document(Report, found.report).text()
    return told


def _line(found: Found[Any], folder: str) -> list[Value]:
    result = [found.number, found.points, found.score, found.max_score, found.overridden, found.fault]
    return [found.person, str(found.id), moment(found.submitted_at), found.late, found.status, *result, found.sha256, folder]


def _lines(columns: Sequence[str], found: Sequence[Found[Any]]) -> str:
    return BYTE_ORDER_MARK + table(columns, [[_value(getattr(row, name)) for name in columns] for row in found])


def _value(value: object) -> Value:
    if isinstance(value, datetime):
        return moment(value)
    return value if value is None or isinstance(value, int | str) else str(value)
