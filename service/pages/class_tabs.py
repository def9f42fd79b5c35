"""The class pages of an assignment, for staff: overview, students, checks, submissions and settings, each a tab."""

import gzip
from statistics import median
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
from service.pages import class_charts, class_stats
from service.store import sweeps
from service.store.course import deadlines, gradebook, progress
from service.store.course.gradebook import StudentRow

router = APIRouter()


class SubmissionFilter(BaseModel):
    """Filter of submissions by check, check state and cause."""

    check: str | None = Field(None, max_length=100)
    state: str | None = Field(None, max_length=20)
    cause: str | None = Field(None, max_length=400)


@router.get("/assignments/{slug}/class", response_class=HTMLResponse)
async def overview(request: Request, person: Staff, assignment: Assigned, database: Db) -> Response:
    """Show what the class has submitted: points, progress, the most common causes of failures, and exports."""
    slug, most = assignment.slug, assignment.max_points()
    students, rules = await gradebook.student_rows(database, slug), await gradebook.rules(database, slug)
    points = [s.final for s in students if s.final is not None]
    return _page(
        request,
        "class_overview.html",
        assignment,
        rules=rules,
        median=median(points) if points else None,
        distribution=class_charts.distribution(students, most),
        progress=class_charts.progress(await progress.of_class(database, slug), rules.students, most, rules.due_at),
        causes=class_stats.by_cause(students),
        submission_counts=class_stats.submission_counts(students),
        extensions=await deadlines.extensions(database, slug),
        swept=await sweeps.count(database, students) if assignment.sweep is not None else None,
    )


@router.get("/assignments/{slug}/class/students", response_class=HTMLResponse)
async def show_students(
    request: Request,
    person: Staff,
    assignment: Assigned,
    database: Db,
    sort: Literal["name", "points", "worst", "activity"] = "name",
    show: Literal["all", "no-gain"] = "all",
) -> Response:
    """Show the results of all students by check, or of those whose later submissions brought no points."""
    everyone = await gradebook.student_rows(database, assignment.slug)
    activity = class_stats.activity(await progress.of_class(database, assignment.slug), assignment.max_points())
    no_gain = [s for s in everyone if s.name in activity and activity[s.name].no_gain]
    students = no_gain if show == "no-gain" else list(everyone)
    if sort in ("points", "worst"):
        students.sort(key=lambda s: -1 if s.final is None else s.final, reverse=sort == "points")
    elif sort == "activity":
        students.sort(key=lambda s: activity[s.name].last_at.timestamp() if s.name in activity else 0.0, reverse=True)
    ids = [c.id for c in assignment.checks()]
    page = _page(
        request,
        "class_students.html",
        assignment,
        students=[(s, activity.get(s.name), class_stats.row(s, ids)) for s in students],
        equal_names=class_stats.equal_names(everyone),
        total=len(everyone),
        no_gain=len(no_gain),
        passed=class_stats.passed(students, ids),
        sort=sort,
        show=show,
    )
    return _compressed(request, page)


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
        equal_names=class_stats.equal_names(students),
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


def _compressed(request: Request, page: Response) -> Response:
    """Return the page compressed if the browser can read that. The page must have no form: compression can leak a form's token."""
    if "gzip" not in request.headers.get("accept-encoding", ""):
        return page
    headers = {"Content-Encoding": "gzip", "Vary": "Accept-Encoding"}
    return HTMLResponse(gzip.compress(bytes(page.body), 3), page.status_code, headers)


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
