"""A roster: who is in the course, from a CSV file."""

import csv
import io
from typing import Any, NamedTuple

from service.store import people

COLUMNS = people.ROSTER
LONGEST = 200


class BadRoster(ValueError):
    """The file is no roster; the message names the line."""


class Entry(NamedTuple):
    """A person of a roster; what is None is left as it is."""

    name: str
    role: str | None = None
    full_name: str | None = None
    email: str | None = None
    student_id: str | None = None


def read(content: bytes, file: str) -> list[Entry]:
    """An entry for every line; BadRoster for what is none. ``file`` is what the message calls it."""
    try:
        rows = csv.reader(io.StringIO(content.decode("utf-8-sig"), newline=""))
        found = _read(rows, file)
    except (UnicodeDecodeError, csv.Error) as error:
        raise BadRoster(f"{file} is no CSV text in UTF-8 ({error})") from None
    if not found:
        raise BadRoster(f"{file} names nobody")
    return found


def _read(rows: Any, file: str) -> list[Entry]:
    columns = [cell.strip().casefold().replace(" ", "_") for cell in next(rows, [])]
    if "name" not in columns or (unknown := set(columns) - set(COLUMNS)) or len(set(columns)) < len(columns):
        told = f", not {sorted(unknown)[0][:40]!r}" if "name" in columns and unknown else ""
        raise BadRoster(f"{file}: the first line names the columns, name and, if wanted, {', '.join(COLUMNS[1:])}{told}")
    found: dict[str, Entry] = {}
    for cells in rows:
        if not any(cell.strip() for cell in cells):
            continue
        try:
            entry = _entry(dict(zip(columns, cells, strict=False)))
        except ValueError as error:
            raise BadRoster(f"{file}, line {rows.line_num}: {error}") from None
        if found.setdefault(entry.name, entry) != entry:
            raise BadRoster(f"{file}, line {rows.line_num}: {entry.name} is told twice, and differently")
    return list(found.values())


def _entry(row: dict[str, str]) -> Entry:
    role = row.get("role", "").strip().casefold() or None
    if role not in (None, *people.ROLES):
        raise ValueError(f"a role is {', '.join(people.ROLES)}, not {role[:40]}")
    about = {name: " ".join(row[name].split()) for name in COLUMNS[2:] if name in row}
    for name, told in about.items():
        if len(told) > LONGEST or not told.isprintable():
            raise ValueError(f"{name} has at most {LONGEST} printable characters")
    return Entry(people.tidy(row.get("name", "")), role, **about)
