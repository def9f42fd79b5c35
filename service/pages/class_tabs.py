"""The class pages of an assignment, for staff: overview, students, checks, submissions and settings, each a tab."""

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Request, Response
from fastapi.responses import HTMLResponse
from pydantic import BaseModel, Field

from exercises.assignment import Assignment
from service.api.submissions import Assigned
from service.auth.roles import Staff
from service.grading import result
from service.http.state import Db
from service.http.templating import templates
from service.pages import class_stats
from service.store import sweeps
from service.store.course import deadlines, gradebook
from service.store.course.gradebook import StudentRow

router = APIRouter()


class SubmissionFilter(BaseModel):
    """Filter of submissions by check, check state and cause."""

    check: str | None = Field(None, max_length=100)
    state: str | None = Field(None, max_length=20)
    cause: str | None = Field(None, max_length=400)


@router.get("/assignments/{slug}/class", response_class=HTMLResponse)
async def overview(request: Request, person: Staff, assignment: Assigned, database: Db) -> Response:
    """Show what the class has submitted, the most common causes of failures, and exports."""
    slug = assignment.slug
    students = await gradebook.student_rows(database, slug)
    return _page(
        request,
        "class_overview.html",
        assignment,
        rules=await gradebook.rules(database, slug),
        causes=class_stats.by_cause(students),
        submission_counts=class_stats.submission_counts(students),
        extensions=await deadlines.extensions(database, slug),
        swept=await sweeps.count(database, students) if assignment.sweep is not None else None,
    )


@router.get("/assignments/{slug}/class/students", response_class=HTMLResponse)
async def show_students(
    request: Request, person: Staff, assignment: Assigned, database: Db, sort: Literal["name", "points"] = "name"
) -> Response:
    """Show the results of all students by check."""
    students = await gradebook.student_rows(database, assignment.slug)
    if sort == "points":
        students.sort(key=lambda s: -1 if s.points is None else s.points, reverse=True)
    ids = [c.id for c in assignment.checks()]
    return _page(
        request,
        "class_students.html",
        assignment,
        students=[(s, class_stats.row(s, ids)) for s in students],
        checks=class_stats.by_check(assignment, students),
        sort=sort,
    )


@router.get("/assignments/{slug}/class/checks", response_class=HTMLResponse)
async def show_checks(request: Request, person: Staff, assignment: Assigned, database: Db) -> Response:
    """Show the results, margins and most common causes by check."""
    checks = class_stats.by_check(assignment, await gradebook.student_rows(database, assignment.slug))
    return _page(
        request,
        "class_checks.html",
        assignment,
        checks=checks,
        decades=class_stats.DECADES,
        most_bin=max((max(c.bins) for c in checks), default=0),
        small_margin=class_stats.SMALL_MARGIN,
    )


@router.get("/assignments/{slug}/class/submissions", response_class=HTMLResponse)
async def show_submissions(
    request: Request, person: Staff, assignment: Assigned, database: Db, selection: Annotated[SubmissionFilter, Query()]
) -> Response:
    """Show the counted submissions that match a check, its state or a cause."""
    check, state, cause = selection.check, selection.state, selection.cause
    students = await gradebook.student_rows(database, assignment.slug)
    found = [s for s in students if _matches(s, check, state, cause)]
    label = next((c.label for c in assignment.checks() if c.id == check), check)
    return _page(
        request,
        "class_submissions.html",
        assignment,
        students=found,
        total=len(students),
        check=check,
        label=label,
        state=state,
        cause=cause,
    )


@router.get("/assignments/{slug}/class/settings", response_class=HTMLResponse)
async def show_settings(
    request: Request, person: Staff, assignment: Assigned, database: Db, removed: Annotated[str, Query(max_length=200)] = ""
) -> Response:
    """Show deadline, limits and extensions, which instructors can change. The extension of ``removed`` can be restored."""
    slug = assignment.slug
    return _page(
        request,
        "class_settings.html",
        assignment,
        rules=await gradebook.rules(database, slug),
        students=await gradebook.students(database, slug),
        extensions=await deadlines.extensions(database, slug),
        removed=await deadlines.removed_extension(database, slug, removed.replace("\x00", "")),
    )


def _page(request: Request, template: str, assignment: Assignment, **context: Any) -> Response:
    common = {"assignment": assignment, "marks": result.MARKS, "state_labels": result.WORDS}
    return templates.TemplateResponse(request, template, common | context)


def _matches(student: StudentRow, check: str | None, state: str | None, cause: str | None) -> bool:
    """Return whether a student matches.

    ``state`` is a check state, "none" (no submission) or "not-pass" (any state but pass).
    """
    if state == "none" and check is None:
        return student.submission is None
    cells = [cell for id, cell in student.cells.items() if check in (None, id) and (cell.counted or check is None)]
    if state is not None:
        cells = [c for c in cells if (c.shown != "pass" if state == "not-pass" else c.shown == state)]
    if cause is not None:
        cells = [c for c in cells if c.shown != "pass" and cause in (sentence for _, sentence in c.causes)]
    return bool(cells) or (check is state is cause is None)
