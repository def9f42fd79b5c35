"""The class page of an assignment, for staff: results, statistics, exports, deadlines and extensions."""

from contextlib import suppress
from datetime import UTC, datetime
from typing import Annotated, Literal

from fastapi import APIRouter, Query, Request, Response
from fastapi.responses import HTMLResponse, RedirectResponse
from pydantic import BaseModel, Field
from starlette.datastructures import FormData

from service.api.figure_renderer import Renderer
from service.api.submissions import Assigned
from service.auth import forms
from service.auth.roles import Instructor, Staff
from service.grading import result
from service.http.errors import Problem
from service.http.state import Db, Held
from service.http.templating import templates
from service.pages import class_stats
from service.store import queue_overview, sweeps
from service.store.course import deadlines, gradebook
from service.store.course.gradebook import StudentRow

router = APIRouter()
MOST_GRACE_MIN, MOST_ALLOWED, MOST_WEIGHT = 60 * 24 * 366, 10_000, 1000
YEARS = range(2000, 3000)  # other years are typing errors; date arithmetic overflows near the ends of the calendar


class SubmissionFilter(BaseModel):
    """Filter of submissions by check, check state and cause."""

    check: str | None = Field(None, max_length=100)
    state: str | None = Field(None, max_length=20)
    cause: str | None = Field(None, max_length=400)


@router.get("/assignments/{slug}/class", response_class=HTMLResponse)
async def class_page(
    request: Request, person: Staff, assignment: Assigned, database: Db, sort: Literal["name", "points"] = "name"
) -> Response:
    """Show the results of all students by check, and statistics."""
    slug = assignment.slug
    students = await gradebook.student_rows(database, slug)
    if sort == "points":
        students.sort(key=lambda s: -1 if s.points is None else s.points, reverse=True)
    checks = class_stats.by_check(assignment, students)
    context = {
        "assignment": assignment,
        "rules": await gradebook.rules(database, slug),
        "students": [(s, class_stats.row(s, [c.id for c in assignment.checks()])) for s in students],
        "sort": sort,
        "checks": checks,
        "causes": class_stats.by_cause(students),
        "submission_counts": class_stats.submission_counts(students),
        "decades": class_stats.DECADES,
        "most_bin": max((max(c.bins) for c in checks), default=0),
        "small_margin": class_stats.SMALL_MARGIN,
        "marks": result.MARKS,
        "state_labels": result.WORDS,
        "extensions": await deadlines.extensions(database, slug),
        "swept": await sweeps.count(database, students) if assignment.sweep is not None else None,
    }
    return templates.TemplateResponse(request, "class.html", context)


@router.get("/assignments/{slug}/class/submissions", response_class=HTMLResponse)
async def filtered_submissions(
    request: Request, person: Staff, assignment: Assigned, database: Db, selection: Annotated[SubmissionFilter, Query()]
) -> Response:
    """Show the counted submissions that match a check, its state or a cause."""
    check, state, cause = selection.check, selection.state, selection.cause
    students = await gradebook.student_rows(database, assignment.slug)
    found = [s for s in students if _matches(s, check, state, cause)]
    label = next((c.label for c in assignment.checks() if c.id == check), check)
    context = {"assignment": assignment, "students": found, "total": len(students), "check": check, "label": label}
    context |= {"state": state, "cause": cause, "state_labels": result.WORDS, "marks": result.MARKS}
    return templates.TemplateResponse(request, "filtered_submissions.html", context)


@router.get("/assignments/{slug}/class/sweep.svg")
async def class_sweep(person: Staff, assignment: Assigned, database: Db, renderer: Held[Renderer]) -> Response:
    """Return the speed vs accuracy chart of the class's measured functions and the reference methods."""
    documents = await sweeps.documents(database, await gradebook.students(database, assignment.slug))
    if not documents:
        raise Problem(404, "not-found", "no submission has been measured yet: start the measurement on the class page")
    return Response(await renderer.class_sweep(documents), media_type="image/svg+xml")


@router.post("/assignments/{slug}/class/sweep")
async def sweep_class(person: Staff, form: forms.Form, assignment: Assigned, database: Db) -> Response:
    """Queue the speed vs accuracy sweep of all counted submissions, after all waiting gradings."""
    await sweeps.request_class(database, await gradebook.students(database, assignment.slug))
    return RedirectResponse(f"/assignments/{assignment.slug}/class#speed", 303)


@router.post("/assignments/{slug}/rules")
async def set_rules(person: Instructor, form: forms.Form, assignment: Assigned, database: Db) -> Response:
    """Set deadline, grace period, submission limit and weight. An empty field means no limit, and the weight 1."""
    grace = _number(form, "grace", 0, MOST_GRACE_MIN) or 0.0
    most = _number(form, "most", 1, MOST_ALLOWED)
    weight = _number(form, "weight", 0, MOST_WEIGHT)
    rules = queue_overview.Rules(
        _datetime(form, "due"), 60.0 * grace, None if most is None else int(most), 1.0 if weight is None else weight
    )
    await queue_overview.set_rules(database, assignment.slug, rules, person.name)
    return RedirectResponse(f"/assignments/{assignment.slug}/class", 303)


@router.post("/assignments/{slug}/extensions")
async def extend(person: Instructor, form: forms.Form, assignment: Assigned, database: Db) -> Response:
    """Give one person a new deadline with a reason. An empty deadline removes the extension."""
    slug, due, reason = assignment.slug, _datetime(form, "due"), forms.field(form, "reason")
    name = await _login_name(database, slug, forms.field(form, "name"))
    if due is None:
        if not await deadlines.remove_extension(database, slug, name, person.name):
            raise Problem(422, "invalid-request", f"{name or 'this person'} has no extension to remove: check the name", "/name")
    elif not reason:
        raise Problem(422, "invalid-request", "an extension needs a reason: enter one", "/reason")
    elif due <= datetime.now(UTC):
        raise Problem(422, "invalid-request", "this deadline is past: enter a later one", "/due")
    elif not await deadlines.extend(database, slug, name, due, reason=reason, by=person.name):
        raise Problem(422, "invalid-request", f"no person named {name!r} in the course: check the name", "/name")
    return RedirectResponse(f"/assignments/{slug}/class#extensions", 303)


async def _login_name(database: Db, slug: str, name: str) -> str:
    """Return the login name of the only student with that full name, else ``name``."""
    found = [s.name for s in await gradebook.students(database, slug) if name and s.full_name == name]
    if len(found) > 1:
        raise Problem(422, "invalid-request", f"several students are named {name}: enter one of {', '.join(found)}", "/name")
    return found[0] if found else name


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


def _datetime(form: FormData, name: str) -> datetime | None:
    """Return a datetime-local field in UTC, None if it is empty. Raises Problem 422 if it is invalid."""
    if not (text := forms.field(form, name, 40)):
        return None
    with suppress(ValueError):
        at = datetime.fromisoformat(text)
        if at.year in YEARS:
            return at.replace(tzinfo=UTC) if at.tzinfo is None else at
    raise Problem(422, "invalid-request", f"expected a date and time such as 2026-12-01T12:00, got {text[:40]!r}", f"/{name}")


def _number(form: FormData, name: str, least: int, most: int) -> float | None:
    if not (text := forms.field(form, name, 40)):
        return None
    with suppress(ValueError):
        if least <= (number := float(text)) <= most:
            return number
    raise Problem(422, "invalid-request", f"expected a number from {least} to {most}, got {text[:40]!r}", f"/{name}")
