"""Comments of the course staff on lines of a submission's source, and the students' answers to them."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from uuid import UUID

from service.store.course import audit
from service.store.database import Database, Row
from service.store.people.people import COURSE

LONGEST = 2000
MOST = 200  # of one submission
LATEST = 50


@dataclass(frozen=True)
class Comment:
    """A comment on line ``line`` of cell ``cell``, both counted from 1."""

    id: UUID
    cell: int
    line: int
    comment: str
    author: str
    written_at: datetime


async def of_submission(database: Database, submission: UUID) -> Sequence[Comment]:
    """Return the comments on a submission in the order of its lines."""
    return [Comment(**row._asdict()) for row in await database.rows(_ALL, {"submission": submission})]


async def latest_answers(database: Database, slug: str) -> Sequence[Row]:
    """Return the latest answers of students to comments about an assignment, newest first, with the
    ``submission`` and the student's ``full_name``.
    """
    return await database.rows(_LATEST_ANSWERS, {"slug": slug, "course": COURSE, "most": LATEST})


async def write(
    database: Database, submission: UUID, author: str, *, cell: int, line: int, comment: str
) -> Comment:
    """Store a comment on a line, which must exist, and return it."""
    values = {"submission": submission, "cell": cell, "line": line, "comment": comment, "author": author}
    async with database.begin() as connection:
        written = Comment(**(await connection.one(_WRITE, values))._asdict())
        await audit.record(
            connection, author, "comment", str(submission), {"cell": cell, "line": line, "comment": comment}
        )
    return written


async def delete(database: Database, submission: UUID, id: UUID, actor: str) -> bool:
    """Delete a comment; the audit log keeps its text. Return False if the submission has no such comment."""
    async with database.begin() as connection:
        row = await connection.first(_DELETE, {"submission": submission, "id": id})
        if row is not None:
            await audit.record(connection, actor, "comment deleted", str(submission), row._asdict())
    return row is not None


_COLUMNS = "id, cell, line, comment, author, written_at"

_ALL = (
    f"SELECT {_COLUMNS} FROM source_comment WHERE submission_id = %(submission)s ORDER BY cell, line,"
    " written_at, id"
)

_LATEST_ANSWERS = """
SELECT c.submission_id AS submission, c.cell, c.line, c.comment, c.author, c.written_at, p.full_name
FROM source_comment c JOIN submission s ON s.id = c.submission_id
    JOIN person p ON p.id = s.person_id AND p.name = c.author
    JOIN assignment x ON x.id = s.assignment_id JOIN course ON course.id = x.course_id
WHERE x.slug = %(slug)s AND course.slug = %(course)s
ORDER BY c.written_at DESC, c.id LIMIT %(most)s
"""

_WRITE = f"""
INSERT INTO source_comment (submission_id, cell, line, comment, author)
VALUES (%(submission)s, %(cell)s, %(line)s, %(comment)s, %(author)s) RETURNING {_COLUMNS}
"""

_DELETE = """
DELETE FROM source_comment WHERE id = %(id)s AND submission_id = %(submission)s
    RETURNING cell, line, comment, author
"""
