"""Compare a roster with the course, and import it."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from service.store.course import audit
from service.store.database import Connection, Queries, Row
from service.store.people import people, tokens
from service.store.people.roster.problems import Question, count
from service.store.people.roster.reading import Entry, Roster


@dataclass(frozen=True)
class Change:
    """What the import does to a person: ``kind`` is "new", "changed" or "unchanged"; ``columns`` has the old
    and the new value of each column that changes.
    """

    entry: Entry
    kind: str
    columns: Mapping[str, tuple[str, str]]


@dataclass(frozen=True)
class Plan:
    """What the import of a roster would do. ``absent`` are the students whom the file does not name.

    ``errors`` must be corrected first, and ``questions`` confirmed.
    """

    roster: Roster
    changes: Sequence[Change]
    absent: Sequence[Row]
    errors: Sequence[str]
    questions: Sequence[Question]

    def number(self, kind: str) -> int:
        """Return how many people are "new", "changed" or "unchanged"."""
        return sum(change.kind == kind for change in self.changes)

    def open_questions(self, confirmed: Collection[str]) -> list[Question]:
        """Return the questions whose keys are not among those ``confirmed``."""
        return [question for question in self.questions if question.key not in confirmed]


async def compare(queries: Queries, roster: Roster, importer: str | None) -> Plan:
    """Return what the import would do. ``importer`` is the instructor who must not remove their own role."""
    known = {row.name: row for row in await people.members(queries)}
    errors = [*roster.errors]
    staying, changes = [], []
    for listed in roster.entries:
        entry, person = listed, known.get(listed.name)
        if person is not None and person.role in people.STAFF and entry.role == "student":
            staying.append(f"{entry.name}: {person.role} in the course, student in the file")
            entry = entry._replace(role=None)
        if entry.name == importer and entry.role not in (None, "instructor"):
            errors.append("this roster would remove your own instructor role: correct your line")
        changes.append(_change(entry, person))
    if _loses_instructors(known, changes):
        errors.append("this roster would leave the course without an instructor: correct a role")
    questions = [*roster.questions]
    if staying:
        are = count(len(staying), "member of the staff is a student", "members of the staff are students")
        questions.append(Question(f"{are} in the file; they keep their roles.", staying))
    if alike := _alike(changes, known):
        are = count(len(alike), "person seems", "people seem")
        questions.append(Question(f"{are} to be in the course under another login name.", alike))
    named = {change.entry.name for change in changes}
    absent = [row for row in known.values() if row.role == "student" and row.name not in named]
    return Plan(roster, changes, absent, errors, questions)


def _loses_instructors(known: Mapping[str, Row], changes: Collection[Change]) -> bool:
    """Return whether the course has an instructor now and would have none."""
    before = {name: row.role for name, row in known.items()}
    after = before | {change.entry.name: change.entry.role for change in changes if change.entry.role}
    return "instructor" in before.values() and "instructor" not in after.values()


async def carry_out(
    connection: Connection, plan: Plan, actor: str, token_s: float | None
) -> list[tuple[str, str]]:
    """Import the people of a plan without errors, and return (name, new token) of each.

    Tokens are valid for ``token_s`` seconds; None creates none.
    """
    entries = [change.entry for change in plan.changes]
    await people.enroll(connection, entries)
    created: list[tuple[str, str]] = []
    if token_s is not None:
        created = await tokens.create_all(
            connection,
            [entry.name for entry in entries],
            label="issued with the roster",
            scopes=tokens.SCOPES,
            seconds=token_s,
        )
    numbers = {"people": len(entries), "tokens": len(created)}
    await audit.record(connection, actor, "roster", plan.roster.file, numbers)
    return created


def _change(entry: Entry, known: Row | None) -> Change:
    if known is None:
        return Change(entry, "new", {})
    pairs = {column: (getattr(known, column), getattr(entry, column)) for column in people.ROSTER[1:]}
    changed = {column: (old, new) for column, (old, new) in pairs.items() if new is not None and new != old}
    return Change(entry, "changed" if changed else "unchanged", changed)


def _alike(changes: Sequence[Change], known: Mapping[str, Row]) -> list[str]:
    """Return a text for each new person whose login name, address or student id somebody else has."""
    owners: dict[str, str] = {}
    for row in known.values():
        owners |= {value.casefold(): row.name for value in (row.student_id, row.email, row.name) if value}
    found = []
    for change in changes:
        entry = change.entry
        for value in (entry.name, entry.email, entry.student_id) if change.kind == "new" else ():
            if value and (owner := owners.get(value.casefold(), entry.name)) != entry.name:
                found.append(f"{entry.name} (new) and {owner} share {value}")
                break
    return found
