"""Read a roster: its people, and what is unclear about them."""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from service.store.people.people import ROLES, normalize_name
from service.store.people.roster.columns import BEFORE_AT, CANVAS, FIELDS, Columns, choose, plain
from service.store.people.roster.problems import Question, count, lines
from service.store.people.roster.roles import highest, role_of
from service.store.people.roster.table import Line, Table, read_table
from service.store.people.roster.text import DAMAGED, decode

LONGEST = 200
SKIP = "skip"
"""What may be chosen for a role that is not understood, beside a role."""


class Entry(NamedTuple):
    """A person of a roster, in the order of ``people.enroll``; fields that are None stay unchanged."""

    name: str
    role: str | None = None
    full_name: str | None = None
    email: str | None = None
    student_id: str | None = None
    section: str | None = None
    surname: str | None = None


@dataclass(frozen=True)
class Choices:
    """What whoever imports a roster has chosen in place of a guess: the heading by field, the role by word,
    and the encoding.
    """

    columns: Mapping[str, str] = field(default_factory=dict)
    roles: Mapping[str, str] = field(default_factory=dict)
    encoding: str | None = None


@dataclass
class Roster:
    """The people of a file, and how it was read.

    ``roles`` are the words that name no role, with what was chosen for them. ``errors`` must be corrected,
    and ``questions`` confirmed, before an import; ``notes`` are what was left out because it is no person.
    """

    file: str
    encoding: str
    columns: Columns
    entries: Sequence[Entry] = ()
    roles: dict[str, str] = field(default_factory=dict)
    errors: list[str] = field(default_factory=list)
    questions: list[Question] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def read(content: bytes, file: str, choices: Choices | None = None) -> Roster:
    """Read a roster of any tool, with an entry per person.

    Raises BadRoster, with ``file`` in its message, if it is not text in lines and columns, or if a choice
    does not fit.
    """
    choices = choices or Choices()
    table = read_table(decode(content, file, choices.encoding), file)
    found = Roster(file, table.text.encoding, choose(table.headings, choices.columns))
    found.roles = {word: role if role in ROLES else SKIP for word, role in choices.roles.items()}
    _ask_about_text(found, table)
    if found.columns.unknown:
        found.questions.append(
            Question("These columns are not understood and not imported.", found.columns.unknown)
        )
    if "login" not in found.columns.headings:
        found.errors.append(
            "no column holds login names: the first line must name the columns; it has"
            f" {', '.join(table.headings)}: choose the column with the login names"
        )
        return found
    people = _people(found, table)
    found.entries = _merged(found, people)
    _ask_about_shared(found)
    if not found.entries and not found.errors:
        found.errors.append("nobody would be imported: add a line for each person")
    return found


def _ask_about_text(found: Roster, table: Table) -> None:
    if table.text.guessed:
        rows = [table.headings, *(line.cells for line in (*table.above, *table.lines))]
        words = dict.fromkeys(cell.strip() for cells in rows for cell in cells if not cell.isascii())
        sentence = (
            f"The file is not in UTF-8 and was read as {table.text.encoding}: these words must look right."
        )
        found.questions.append(Question(sentence, [*words]))
    damaged = [
        f"line {line.number}: {cell.strip()}"
        for line in table.lines
        for cell in line.cells
        if DAMAGED.search(cell)
    ]
    if damaged:
        found.questions.append(
            Question("Letters or numbers look damaged: save the file again as CSV UTF-8.", damaged)
        )
    if any(cell.strip() for line in table.above for cell in line.cells):
        above = [" ".join(" ".join(line.cells).split()) for line in table.above]
        found.questions.append(Question("These lines above the headings are skipped.", above))


def _people(found: Roster, table: Table) -> list[tuple[Line, Entry]]:
    """Return each line with its entry. Lines that are skipped become questions or notes."""
    people, nameless = [], []
    unknown: dict[str, list[int]] = defaultdict(list)
    for line in _persons(found, table):
        values = _values(found.columns, line)
        if not values["login"]:
            nameless.append(f"line {line.number}: {', '.join(filter(None, line.cells))}")
            continue
        word = values.get("role", "")
        role = role_of(word) if word else None
        if word and role is None:
            unknown[word].append(line.number)
            role = found.roles.setdefault(word, SKIP)
        if role == SKIP:
            continue
        try:
            people.append((line, _entry(values, role)))
        except ValueError as error:
            found.errors.append(f"line {line.number}: {error}")
    found.roles = {word: found.roles[word] for word in unknown}
    if nameless:
        are = count(len(nameless), "line has", "lines have")
        found.questions.append(Question(f"{are} no login name and will be skipped.", nameless))
    for word, numbers in unknown.items():
        if found.roles[word] == SKIP:
            are = count(len(numbers), "person is", "people are")
            sentence = f"The role “{word[:40]}” is not understood: {are} skipped."
            found.questions.append(Question(sentence, [lines(numbers)]))
    return people


def _persons(found: Roster, table: Table) -> Iterator[Line]:
    """Yield the lines that are about a person, with a tidy cell for each heading."""
    headings = [plain(heading) for heading in table.headings]
    # In Canvas's gradebook rows without an ID are not people, such as "Points Possible".
    id_place = headings.index("id") if CANVAS.issubset(headings) else None
    for line in table.lines:
        cells = [" ".join(cell.split()) for cell in line.cells]
        if any(cells[len(headings) :]):
            found.errors.append(
                f"line {line.number} has more cells than there are columns: put a value that contains the"
                " separator in quotation marks"
            )
            continue
        cells = (cells + [""] * len(headings))[: len(headings)]
        if id_place is not None and not cells[id_place]:
            found.notes.append(f"line {line.number} is not a person: {cells[0]}")
            continue
        yield Line(line.number, cells)


def _values(columns: Columns, line: Line) -> dict[str, str]:
    """Return the line's value by field."""
    values = {name: line.cells[place] for name in FIELDS if (place := columns.place(name)) is not None}
    if columns.headings["login"] == BEFORE_AT:
        values["login"] = values["email"].partition("@")[0]
    return values


def _entry(values: Mapping[str, str], role: str | None) -> Entry:
    """Return the entry of a line. Raises ValueError if a value cannot be stored."""
    for name, value in values.items():
        if name != "login" and (len(value) > LONGEST or not value.isprintable()):
            raise ValueError(f"the {FIELDS[name]} must have at most {LONGEST} printable characters")
    full_name = values.get("full_name") or f"{values.get('first', '')} {values.get('last', '')}".strip()
    surname = values.get("last", "")
    return Entry(
        name=normalize_name(values["login"]),
        role=role,
        full_name=full_name or None,
        email=values.get("email") or None,
        student_id=values.get("student_id") or None,
        section=values.get("section") or None,
        surname=surname if surname and full_name.endswith(surname) else None,
    )


def _merged(found: Roster, people: Sequence[tuple[Line, Entry]]) -> list[Entry]:
    """Return one entry per login name; lines that contradict each other become errors."""
    by_name: dict[str, list[tuple[Line, Entry]]] = defaultdict(list)
    for line, entry in people:
        by_name[entry.name].append((line, entry))
    entries, merged = [], []
    for name, same in by_name.items():
        numbers = lines(line.number for line, _ in same)
        if wrong := _contradictions([entry for _, entry in same]):
            found.errors.append(
                f"{numbers}: {name} has different values ({'; '.join(wrong)}): keep one line, or choose"
                " another column for the login names"
            )
        entries.append(_merge([entry for _, entry in same]))
        if len(same) > 1:
            merged.append(f"{numbers}: {name}")
    if merged and not found.errors:
        are = count(len(merged), "person is", "people are")
        found.questions.append(Question(f"{are} listed more than once; the lines are merged.", merged))
    return entries


def _contradictions(entries: Sequence[Entry]) -> list[str]:
    wrong = []
    for column in ("full_name", "email", "student_id"):
        values = dict.fromkeys(value for entry in entries if (value := getattr(entry, column)))
        if len({value.casefold() for value in values}) > 1:
            wrong.append(f"{FIELDS[column]} {' and '.join(values)}")
    return wrong


def _merge(entries: Sequence[Entry]) -> Entry:
    """Return what several lines say of a person: the first value, the highest role, and all sections."""
    first = {
        column: next((value for entry in entries if (value := getattr(entry, column))), None)
        for column in Entry._fields
    }
    if roles := [entry.role for entry in entries if entry.role]:
        first["role"] = highest(roles)
    if sections := dict.fromkeys(entry.section for entry in entries if entry.section):
        first["section"] = ", ".join(sections)
    return Entry(**first)  # type: ignore[arg-type]


def _ask_about_shared(found: Roster) -> None:
    """Ask about login names that seem to be one person: they share an address or a student ID."""
    for column, what in {"email": "an email address", "student_id": "a student ID"}.items():
        logins: dict[str, list[str]] = defaultdict(list)
        for entry in found.entries:
            if value := getattr(entry, column):
                logins[value.casefold()].append(entry.name)
        shared = [f"{value}: {', '.join(names)}" for value, names in logins.items() if len(names) > 1]
        if shared:
            found.questions.append(
                Question(f"Several login names share {what}; each becomes a person of their own.", shared)
            )
