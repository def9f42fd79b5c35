"""Settings of the course: its name, term and time zone, and the late penalty."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass

from service.store.course import assignment_settings, audit
from service.store.database import Database
from service.store.people.people import COURSE


@dataclass(frozen=True)
class CourseSettings:
    """The course's name and term, "" if it has none, the name of its time zone, and the share of the points
    that a submission loses for each day late, up to a limit (0 to 1).
    """

    title: str = ""
    term: str = ""
    time_zone: str = "UTC"
    late_penalty: float = 0.0
    late_penalty_limit: float = 1.0


async def read(database: Database) -> CourseSettings:
    """Return the settings of the course."""
    row = await database.one(_READ, {"course": COURSE})
    return CourseSettings(**row._asdict())


async def change(
    database: Database, settings: CourseSettings, weights: Mapping[str, float], actor: str
) -> None:
    """Store the settings, and the weights of the assignments that are named."""
    async with database.begin() as connection:
        before = await connection.one(_READ, {"course": COURSE})
        await connection.execute(_SET, asdict(settings) | {"course": COURSE})
        for slug, weight in weights.items():
            await assignment_settings.change_in(connection, slug, {"weight": weight}, actor)
        if changed := audit.changes(before._asdict(), asdict(settings)):
            await audit.record(connection, actor, "course settings", COURSE, changed)


_READ = """
SELECT title, term, time_zone, late_penalty, late_penalty_limit FROM course WHERE slug = %(course)s
"""

_SET = """
UPDATE course SET title = %(title)s, term = %(term)s, time_zone = %(time_zone)s,
    late_penalty = %(late_penalty)s, late_penalty_limit = %(late_penalty_limit)s
WHERE slug = %(course)s
"""
