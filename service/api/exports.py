"""Grade exports for staff: polhode's CSV and JSON, imports for other gradebooks, and a zip of all data."""

import asyncio
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from typing import Literal
from urllib.parse import quote

from fastapi import APIRouter, Response
from fastapi.responses import StreamingResponse

from exercises.authoring.assignments.assignment import Assignment
from exercises.authoring.importing.reported_lines import is_self_reported
from service.api.archive import course_archive
from service.api.submissions import Assigned
from service.auth.roles import Staff
from service.formats import gradebooks
from service.formats import grades as grade_files
from service.formats.filenames import safe_filename
from service.formats.grade_row import GradeRow
from service.http.state import Db
from service.store.course.grades import grades
from service.store.people.people import members

router = APIRouter()
CSV = "text/csv; charset=utf-8"
GRADEBOOKS: dict[str, Callable[[Sequence[GradeRow], Assignment], str]] = {
    "nbgrader": lambda rows, _: gradebooks.nbgrader_csv(rows),
    "canvas": lambda rows, assignment: gradebooks.canvas_csv(rows, assignment.title, assignment.max_points()),
    "gradescope": lambda rows, _: gradebooks.gradescope_csv(rows),
    "moodle": lambda rows, assignment: gradebooks.moodle_csv(rows, assignment.title),
}


@router.get("/grades.csv")
async def course_csv(person: Staff, database: Db) -> Response:
    """Export the course: one row per student with points of every assignment and the weighted total."""
    rows = await grades(database)
    return _file("course-grades.csv", CSV, await asyncio.to_thread(grade_files.course_csv, rows))


@router.get("/assignments/{slug}/grades.csv")
async def assignment_csv(person: Staff, assignment: Assigned, database: Db) -> Response:
    """Export an assignment: one row per student with the state of every check."""
    rows = await grades(database, assignment.slug)
    return _file(f"{assignment.slug}-grades.csv", CSV, await asyncio.to_thread(_csv, assignment, rows))


@router.get("/assignments/{slug}/grades.json")
async def assignment_json(person: Staff, assignment: Assigned, database: Db) -> Response:
    """Export an assignment as JSON."""
    rows = await grades(database, assignment.slug)
    return _file(
        f"{assignment.slug}-grades.json", "application/json", await asyncio.to_thread(_json, assignment, rows)
    )


@router.get("/assignments/{slug}/grades/{form}.csv")
async def gradebook_csv(
    person: Staff,
    assignment: Assigned,
    form: Literal["nbgrader", "canvas", "moodle", "gradescope"],
    database: Db,
) -> Response:
    """Export an assignment as CSV for another gradebook."""
    rows = await grades(database, assignment.slug)
    return _file(
        f"{assignment.slug}-{form}.csv", CSV, await asyncio.to_thread(GRADEBOOKS[form], rows, assignment)
    )


@router.get("/assignments/{slug}/all.zip")
async def all_zip(person: Staff, assignment: Assigned, database: Db) -> Response:
    """Stream a zip of every submission with its report, the grades, the roster and the audit log."""
    rows, people = await grades(database, assignment.slug), await members(database)
    own_csv, own_json = await asyncio.gather(
        *(asyncio.to_thread(form, assignment, rows) for form in (_csv, _json))
    )
    files = {"grades.csv": own_csv, "grades.json": own_json}
    parts = course_archive(database, assignment.slug, files, people)
    return StreamingResponse(
        parts, media_type="application/zip", headers=_headers(f"{assignment.slug}-all.zip")
    )


@router.get("/assignments/{slug}/submissions.zip")
async def submissions_zip(person: Staff, assignment: Assigned, database: Db) -> Response:
    """Stream a zip of every submission's file and report, and their index."""
    parts = course_archive(database, assignment.slug, {}, await members(database), everything=False)
    return StreamingResponse(
        parts, media_type="application/zip", headers=_headers(f"{assignment.slug}-submissions.zip")
    )


def _csv(assignment: Assignment, rows: Sequence[GradeRow]) -> str:
    """Return the CSV with checks in the assignment's order, followed by checks of older versions only."""
    current = dict.fromkeys(check.id for exercise in assignment.exercises for check in exercise.checks)
    return grade_files.assignment_csv(
        rows, [*current, *sorted({check for row in rows for check in row.checks} - current.keys())]
    )


def _json(assignment: Assignment, rows: Sequence[GradeRow]) -> str:
    checks = [
        {
            "id": check.id,
            "exercise": exercise.number,
            "label": check.label,
            "hidden": assignment.hidden(check),
            "points": check.points,
            "self_reported": is_self_reported(check),
        }
        for exercise in assignment.exercises
        for check in exercise.checks
    ]
    about = {"assignment": assignment.slug, "title": assignment.title, "version": assignment.version}
    about |= {"exported_at": datetime.now(UTC).isoformat(timespec="seconds")}
    return grade_files.assignment_json(
        {**about, "max_points": assignment.max_points(), "checks": checks}, rows
    )


def _file(name: str, kind: str, content: str) -> Response:
    return Response(content.encode(), headers={**_headers(name), "Content-Type": kind})


def _headers(name: str) -> dict[str, str]:
    """Return download headers with a plain file name and the exact name in RFC 8187 encoding."""
    stem, _, ending = name.rpartition(".")
    name = f"{stem}-{datetime.now(UTC):%Y-%m-%d}.{ending}"
    plain = safe_filename(name.encode("ascii", "ignore").decode(), f"export.{ending}")
    return {
        "Content-Disposition": f"attachment; filename=\"{plain}\"; filename*=UTF-8''{quote(name, safe='')}",
        "Cache-Control": "no-store",
    }
