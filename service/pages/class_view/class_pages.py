"""The class pages of an assignment, for staff: overview, students, checks, submissions and settings, each a
tab.
"""

import asyncio
import gzip
from statistics import median
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Request, Response
from fastapi.responses import HTMLResponse
from markupsafe import Markup
from pydantic import BaseModel, Field

from exercises.authoring.assignments.assignment import Assignment
from service.api.submissions import Assigned
from service.auth.roles import Staff
from service.grading import graded_file
from service.http.state import Db
from service.http.templating import templates
from service.pages.class_view import charts, statistics
from service.store.course import deadlines, gradebook, outcomes
from service.store.submissions import speed_vs_accuracy

router = APIRouter()
SETTINGS, SUBMISSIONS = "/assignments/{slug}/class/settings", "/assignments/{slug}/class/submissions"


class SubmissionFilter(BaseModel):
    """Filter of submissions by check, check state and cause."""

    check: str | None = Field(None, max_length=100)
    state: str | None = Field(None, max_length=20)
    cause: str | None = Field(None, max_length=400)


@router.get("/assignments/{slug}/class", response_class=HTMLResponse)
async def overview(request: Request, person: Staff, assignment: Assigned, database: Db) -> Response:
    """Show what the class has submitted: points, progress, the most common causes of failures,
    and exports.
    """
    slug, most = assignment.slug, assignment.max_points()
    students, rules = await gradebook.students(database, slug), await gradebook.rules(database, slug)
    points = [s.final for s in students if s.final is not None]
    return _page(
        request,
        "class_overview.html",
        assignment,
        rules=rules,
        median=median(points) if points else None,
        distribution=charts.distribution(students, most),
        progress=charts.progress(students, most, rules.due_at),
        causes=await outcomes.by_cause(database, gradebook.graded(students)),
        submission_counts=statistics.submission_counts(students),
        extensions=await deadlines.extensions(database, slug),
        swept=await speed_vs_accuracy.count(database, students) if assignment.sweep is not None else None,
    )


@router.get("/assignments/{slug}/class/students", response_class=HTMLResponse)
async def show_students(
    request: Request,
    person: Staff,
    assignment: Assigned,
    database: Db,
    sort: Literal["name", "points", "worst", "activity"] = "name",
    show: Literal["all", "no-gain"] = "all",
    by: Literal["exercise", "check"] = "exercise",
) -> Response:
    """Show the results of all students by exercise or check, or of those whose later submissions brought no
    points.
    """
    everyone = await gradebook.students(database, assignment.slug)
    most = assignment.max_points()
    no_gain = {s.name for s in everyone if statistics.has_no_gain(s, most)}
    students = [s for s in everyone if show == "all" or s.name in no_gain]
    if sort in ("points", "worst"):
        students.sort(key=lambda s: -1 if s.final is None else s.final, reverse=sort == "points")
    elif sort == "activity":
        students.sort(key=lambda s: s.sent_at[-1].timestamp() if s.sent_at else 0.0, reverse=True)
    found = await outcomes.by_student(database, gradebook.graded(everyone))
    exercises = [[c.id for c in exercise.checks] for exercise in assignment.exercises]
    ids = [id for checks in exercises for id in checks]
    cells = [
        statistics.exercise_cells(found.get(s.grading, {}), exercises)
        if by == "exercise"
        else statistics.cells(found.get(s.grading, {}), ids)
        for s in students
    ]
    page = _page(
        request,
        "class_students.html",
        assignment,
        # of statistics.CELLS, which are markup
        students=[(s, Markup("".join(row))) for s, row in zip(students, cells, strict=True)],  # noqa: S704
        equal_names=statistics.equal_names(everyone),
        total=len(everyone),
        no_gain=no_gain,
        passed=[statistics.passed(column) for column in zip(*cells, strict=True)],
        sort=sort,
        show=show,
        by=by,
    )
    return _compressed(request, page)


@router.get("/assignments/{slug}/class/checks", response_class=HTMLResponse)
async def show_checks(request: Request, person: Staff, assignment: Assigned, database: Db) -> Response:
    """Show what went wrong by cause, and the results and margins by check."""
    gradings = gradebook.graded(await gradebook.students(database, assignment.slug))
    # at the same time, because each reads all outcomes of the class
    found, causes = await asyncio.gather(
        outcomes.by_check(database, gradings), outcomes.by_cause(database, gradings)
    )
    checks = statistics.by_check(assignment, found)
    return _page(
        request,
        "class_checks.html",
        assignment,
        causes=causes,
        labels={check.id: check.label for check in assignment.checks()},
        checks=checks,
        decades=statistics.DECADES,
        most_bin=max((max(c.bins) for c in checks), default=0),
        small_margin=statistics.SMALL_MARGIN,
    )


@router.get(SUBMISSIONS, response_class=HTMLResponse)
async def show_submissions(
    request: Request,
    person: Staff,
    assignment: Assigned,
    database: Db,
    selection: Annotated[SubmissionFilter, Query()],
) -> Response:
    """Show the counted submissions that match a check, its state or a cause."""
    check, state, cause = (
        None if one is None else one.replace("\x00", "")
        for one in (selection.check, selection.state, selection.cause)
    )
    students = found = await gradebook.students(database, assignment.slug)
    matching = {}
    if state == "none" and check is None:
        found = [s for s in students if s.submission is None]
    elif check is not None or state is not None or cause is not None:
        matching = await outcomes.matching(database, gradebook.graded(students), check, state, cause)
        found = [s for s in students if s.grading in matching]
    labels = {c.id: c.label for c in assignment.checks()}
    page = _page(
        request,
        "class_submissions.html",
        assignment,
        students=found,
        matching=matching,
        total=len(students),
        equal_names=statistics.equal_names(students),
        check=check,
        label=labels.get(check or "", check),
        labels=labels,
        state=state,
        cause=cause,
    )
    return page if check else _compressed(request, page)


@router.get(SETTINGS, response_class=HTMLResponse)
async def show_settings(
    request: Request,
    person: Staff,
    assignment: Assigned,
    database: Db,
    removed: Annotated[str, Query(max_length=200)] = "",
) -> Response:
    """Show deadline, limits and extensions, which instructors can change. The extension of ``removed`` can be
    restored.
    """
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
    common = {"assignment": assignment, "marks": graded_file.MARKS, "state_labels": graded_file.WORDS}
    return templates.TemplateResponse(request, template, common | context)


def _compressed(request: Request, page: Response) -> Response:
    """Return the page compressed if the browser can read that. The page must have no form: compression can
    leak a form's token.
    """
    if "gzip" not in request.headers.get("accept-encoding", ""):
        return page
    headers = {"Content-Encoding": "gzip", "Vary": "Accept-Encoding"}
    return HTMLResponse(gzip.compress(bytes(page.body), 3), page.status_code, headers)
