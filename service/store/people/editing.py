"""Add and change single people, so that of two who edit a person at once none overwrites the other, and the
course keeps an instructor.
"""

from collections.abc import Mapping

from service.store.course import audit
from service.store.database import Connection
from service.store.people.people import COURSE, ROSTER, enroll, has_instructor, lock_members

FIELDS = ROSTER[1:]
"""What can be changed of a person: everything but the login name, by which others know them."""


class KnownPerson(Exception):
    """Somebody of that login name is in the course."""


class LastInstructor(Exception):
    """Without this person the course would have no instructor."""


class ChangedMeanwhile(Exception):
    """Somebody else has changed the person since the form was shown.

    ``changes`` has the value shown and the present one of each field that differs; ``by`` is who changed the
    person last on a page, "" if nobody did.
    """

    def __init__(self, changes: Mapping[str, tuple[str, str]], by: str) -> None:
        super().__init__(changes)
        self.changes, self.by = changes, by


async def add(connection: Connection, name: str, values: Mapping[str, str], by: str) -> None:
    """Add a person with these values of FIELDS. Raises KnownPerson."""
    await lock_members(connection)
    if await connection.first(_READ, {"name": name, "course": COURSE}) is not None:
        raise KnownPerson
    await enroll(connection, [(name, *(values[field] for field in FIELDS))])
    await audit.record(connection, by, "add person", name, values)


async def change(
    connection: Connection, name: str, values: Mapping[str, str], seen: Mapping[str, str], by: str
) -> None:
    """Give a person of the course these values of FIELDS, where ``seen`` are those that the form showed.

    The audit log gets the old and the new value of what differs. Raises ChangedMeanwhile and LastInstructor.
    """
    await lock_members(connection)
    present = (await connection.one(_READ, {"name": name, "course": COURSE}))._asdict()
    if meanwhile := {
        field: (seen[field], present[field]) for field in FIELDS if seen[field] != present[field]
    }:
        last = await connection.first(_LAST_CHANGE, {"name": name})
        raise ChangedMeanwhile(meanwhile, last.actor if last else "")
    changes = {field: values[field] for field in FIELDS if values[field] != present[field]}
    gives_up = "role" in changes and present["role"] == "instructor"
    if gives_up and not await has_instructor(connection, besides=name):
        raise LastInstructor
    if changes:
        await enroll(connection, [(name, *(changes.get(field) for field in FIELDS))])
        await audit.record(connection, by, "person", name, audit.changes(present, changes))


_READ = f"""
SELECT {", ".join("m.role" if field == "role" else f"p.{field}" for field in FIELDS)}
FROM member m JOIN course c ON c.id = m.course_id JOIN person p ON p.id = m.person_id
WHERE c.slug = %(course)s AND p.name = %(name)s
"""
_LAST_CHANGE = """
SELECT actor FROM audit WHERE subject = %(name)s AND action IN ('person', 'add person')
ORDER BY id DESC LIMIT 1
"""
