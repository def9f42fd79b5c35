"""A class at one assignment, for staff: every student by every check, what goes wrong, margins, attempts; rules and extensions."""

from contextlib import suppress
from datetime import UTC, datetime
from typing import Annotated, Literal

from fastapi import APIRouter, Query, Request, Response
from fastapi.responses import HTMLResponse, RedirectResponse
from pydantic import BaseModel, Field
from starlette.datastructures import FormData

from service.api.submissions import find_assignment
from service.auth import forms
from service.auth.roles import Instructor, Staff
from service.grading import result
from service.http.errors import Problem
from service.http.templating import templates
from service.pages import class_stats
from service.store import queue_overview, sweeps
from service.store.course import deadlines, gradebook
from service.store.course.gradebook import StudentRow

router = APIRouter()
MOST_GRACE_MIN, MOST_ALLOWED = 60 * 24 * 366, 10_000
YEARS = range(2000, 3000)  # what is beyond is a slip, and at the ends of the calendar no arithmetic goes well


class SubmissionFilter(BaseModel):
    """Which submissions: by a check, how it ended, a cause that was told."""

    check: str | None = Field(None, max_length=100)
    state: str | None = Field(None, max_length=20)
    cause: str | None = Field(None, max_length=400)


@router.get("/assignments/{slug}/class", response_class=HTMLResponse)
async def class_(slug: str, request: Request, person: Staff, sort: Literal["name", "points"] = "name") -> Response:
    """Every student by every check, and what that amounts to."""
    assignment, database = find_assignment(slug), request.app.state.database
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
        "attempts": class_stats.by_attempts(students),
        "decades": class_stats.DECADES,
        "most_bin": max((max(c.bins) for c in checks), default=0),
        "thin": class_stats.THIN,
        "marks": result.MARKS,
        "words": result.WORDS,
        "extensions": await deadlines.extensions(database, slug),
        "swept": await sweeps.count(database, students) if assignment.sweep is not None else None,
    }
    return templates.TemplateResponse(request, "class.html", context)


@router.get("/assignments/{slug}/class/submissions", response_class=HTMLResponse)
async def chosen(slug: str, request: Request, person: Staff, which: Annotated[SubmissionFilter, Query()]) -> Response:
    """The students' submissions that count, of those whose check ended so, or who were told that cause."""
    assignment = find_assignment(slug)
    check, state, cause = which.check, which.state, which.cause
    students = await gradebook.student_rows(request.app.state.database, slug)
    found = [s for s in students if _fits(s, check, state, cause)]
    label = next((c.label for c in assignment.checks() if c.id == check), check)
    context = {"assignment": assignment, "students": found, "total": len(students), "check": check, "label": label}
    context |= {"state": state, "cause": cause, "words": result.WORDS, "marks": result.MARKS}
    return templates.TemplateResponse(request, "chosen.html", context)


@router.get("/assignments/{slug}/class/sweep.svg")
async def class_sweep(slug: str, request: Request, person: Staff) -> Response:
    """Speed against accuracy of the class's own functions, those swept so far, over the reference methods."""
    find_assignment(slug)
    database = request.app.state.database
    documents = await sweeps.documents(database, await gradebook.students(database, slug))
    if not documents:
        raise Problem(404, "not-found", "nobody's function has been swept yet")
    return Response(await request.app.state.renderer.class_sweep(documents), media_type="image/svg+xml")


@router.post("/assignments/{slug}/class/sweep")
async def sweep_class(slug: str, request: Request, person: Staff, form: forms.Form) -> Response:
    """Have the functions of the submissions that count swept, behind everybody who waits for a grade."""
    find_assignment(slug)
    database = request.app.state.database
    await sweeps.request_class(database, await gradebook.students(database, slug))
    return RedirectResponse(f"/assignments/{slug}/class#speed", 303)


@router.post("/assignments/{slug}/rules")
async def set_rules(slug: str, request: Request, person: Instructor, form: forms.Form) -> Response:
    """Set deadline, grace and number of submissions; what is empty does not limit."""
    find_assignment(slug)
    grace = _number(form, "grace", 0, MOST_GRACE_MIN) or 0.0
    most = _number(form, "most", 1, MOST_ALLOWED)
    rules = queue_overview.Rules(_moment(form, "due"), 60.0 * grace, None if most is None else int(most))
    await queue_overview.set_rules(request.app.state.database, slug, rules, person.name)
    return RedirectResponse(f"/assignments/{slug}/class", 303)


@router.post("/assignments/{slug}/extensions")
async def extend(slug: str, request: Request, person: Instructor, form: forms.Form) -> Response:
    """Give one person a later deadline, with a reason; an empty deadline takes the extension back."""
    find_assignment(slug)
    name, due, reason = forms.field(form, "name"), _moment(form, "due"), forms.field(form, "reason")
    database = request.app.state.database
    if due is None:
        if not await deadlines.remove_extension(database, slug, name, person.name):
            raise Problem(422, "invalid-request", f"{name or 'nobody'} has no extension that could be taken back", "/name")
    elif not reason:
        raise Problem(422, "invalid-request", "an extension has a reason", "/reason")
    elif not await deadlines.extend(database, slug, name, due, reason=reason, by=person.name):
        raise Problem(422, "invalid-request", f"nobody in the course is called {name!r}", "/name")
    return RedirectResponse(f"/assignments/{slug}/class#extensions", 303)


def _fits(student: StudentRow, check: str | None, state: str | None, cause: str | None) -> bool:
    """``state`` may be "none": nothing was sent; or "not-pass": whoever the check is no ✓ for."""
    if state == "none" and check is None:
        return student.submission is None
    cells = [cell for id, cell in student.cells.items() if check in (None, id) and (cell.counted or check is None)]
    if state is not None:
        cells = [c for c in cells if (c.shown != "pass" if state == "not-pass" else c.shown == state)]
    if cause is not None:
        cells = [c for c in cells if c.shown != "pass" and cause in (sentence for _, sentence in c.causes)]
    return bool(cells) or (check is state is cause is None)


def _moment(form: FormData, name: str) -> datetime | None:
    """A field of kind datetime-local, in UTC; None where it is empty."""
    if not (told := forms.field(form, name, 40)):
        return None
    with suppress(ValueError):
        at = datetime.fromisoformat(told)
        if at.year in YEARS:
            return at.replace(tzinfo=UTC) if at.tzinfo is None else at
    raise Problem(422, "invalid-request", f"{told[:40]!r} is no moment such as 2026-12-01T12:00", f"/{name}")


def _number(form: FormData, name: str, least: int, most: int) -> float | None:
    if not (told := forms.field(form, name, 40)):
        return None
    with suppress(ValueError):
        if least <= (number := float(told)) <= most:
            return number
    raise Problem(422, "invalid-request", f"{told[:40]!r} is no number from {least} to {most}", f"/{name}")
