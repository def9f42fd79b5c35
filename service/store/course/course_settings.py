"""Settings of the course: its name, term and time zone, the late penalty, and when the students see scores
and the details of hidden checks.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass

from service.store.course import audit
from service.store.course.people import COURSE
from service.store.database import Database

RELEASES = ("immediately", "deadline", "manually")


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
    row = await database.one(f"SELECT {_COLUMNS} FROM course WHERE slug = %(course)s", {"course": COURSE})
    return CourseSettings(**row._asdict())


async def change(
    database: Database, settings: CourseSettings, weights: Mapping[str, float], actor: str
) -> None:
    """Store the settings, and the weights of the assignments that are named."""
    async with database.begin() as connection:
        await connection.execute(_SET, asdict(settings) | {"course": COURSE})
        for slug, weight in weights.items():
            await connection.execute(_SET_WEIGHT, {"slug": slug, "weight": weight, "course": COURSE})
        await audit.record(
            connection, actor, "course settings", COURSE, {**asdict(settings), "weights": dict(weights)}
        )


async def set_releases(database: Database, slug: str, scores: str, details: str, actor: str) -> None:
    """Set when the students see scores and the details of hidden checks: each is one of RELEASES."""
    async with database.begin() as connection:
        await connection.execute(
            _SET_RELEASES, {"slug": slug, "course": COURSE, "scores": scores, "details": details}
        )
        await audit.record(connection, actor, "release rules", slug, {"scores": scores, "details": details})


async def release(
    database: Database, slug: str, *, scores: bool | None, details: bool | None, actor: str
) -> None:
    """Release scores or details that are released manually (True), withdraw the release (False), or leave it
    as it is (None).
    """
    async with database.begin() as connection:
        await connection.execute(
            _RELEASE, {"slug": slug, "course": COURSE, "scores": scores, "details": details}
        )
        await audit.record(connection, actor, "release", slug, {"scores": scores, "details": details})


_COLUMNS = "title, term, time_zone, late_penalty, late_penalty_limit"

_SET = """
UPDATE course SET title = %(title)s, term = %(term)s, time_zone = %(time_zone)s,
    late_penalty = %(late_penalty)s, late_penalty_limit = %(late_penalty_limit)s
WHERE slug = %(course)s
"""

_OF = "slug = %(slug)s AND course_id = (SELECT id FROM course WHERE slug = %(course)s)"

_SET_WEIGHT = f"UPDATE assignment SET weight = %(weight)s WHERE {_OF}"

_SET_RELEASES = (
    f"UPDATE assignment SET scores_release = %(scores)s, details_release = %(details)s WHERE {_OF}"
)

_RELEASE = f"""
UPDATE assignment SET
    scores_released_at = CASE CAST(%(scores)s AS boolean) WHEN true THEN now() WHEN false THEN NULL
    ELSE scores_released_at END,
    details_released_at = CASE CAST(%(details)s AS boolean) WHEN true THEN now() WHEN false THEN NULL
    ELSE details_released_at END
WHERE {_OF}
"""
