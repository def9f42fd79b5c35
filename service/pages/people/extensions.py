"""Extensions: for many, of some students or all for some assignments or all, and of one person."""

from collections.abc import Sequence
from datetime import timedelta
from typing import Annotated

from fastapi import APIRouter, Query, Request, Response
from fastapi.responses import HTMLResponse, RedirectResponse
from starlette.datastructures import FormData

from exercises.authoring.assignments.catalogue import assignments
from service.auth import forms
from service.auth.roles import Instructor, Staff
from service.http.errors import Problem
from service.http.state import Db
from service.http.templating import templates
from service.pages import form_times
from service.pages.course.settings import overview
from service.pages.rejected_forms import post_form
from service.store.course import deadlines
from service.store.database import Row
from service.store.people import people

router = APIRouter()
Count = Annotated[int | None, Query(ge=0, le=10**6)]
MOST_NAMES = 20_000  # characters of the field
MOST_DAYS = 366
MOST_NAMED = 10  # in an error
EVERYBODY, NAMED, SECTION = "everybody", "named", "section:"


@router.get("/extensions", response_class=HTMLResponse)
async def show(
    request: Request, person: Staff, database: Db, given: Count = None, removed: Count = None
) -> Response:
    """Show the extensions of the whole course, and to instructors the form that gives or removes many."""
    students = await _students(database)
    context = {
        "rows": [row for row in await deadlines.all_extensions(database) if row.slug in assignments()],
        "due": [row for row in await overview(database) if row.published and row.due_at],
        "sections": sorted({one.section for one in students if one.section}),
        "students": len(students),
        "assignments": assignments(),
        "given": given,
        "removed": removed,
    }
    return templates.TemplateResponse(request, "extensions.html", context)


@post_form(router, "/extensions", page=show, at="/extensions")
async def change(person: Instructor, form: forms.Form, database: Db) -> Response:
    """Give the chosen students more time for the chosen assignments, or remove their extensions."""
    names = _chosen(form, await _students(database))
    slugs = [slug for slug in assignments() if f"assignment-{slug}" in form]
    if not slugs:
        raise Problem(422, "invalid-request", "choose an assignment", "/assignments")
    if forms.field(form, "action") == "remove":
        count = await deadlines.remove_many(database, slugs, names, person.name)
        return RedirectResponse(f"/extensions?removed={count}", 303)
    due, days = form_times.moment(form, "due"), forms.number(form, "days", 0, MOST_DAYS, None)
    if (due is None) == (days is None):
        detail = "enter either how many days later, or a date and time that is the same for all"
        raise Problem(422, "invalid-request", detail, "/days")
    if due is not None:
        form_times.refuse_past(due)
    count = await deadlines.extend_many(
        database,
        slugs,
        names,
        due_at=due,
        later=timedelta(days=days or 0),
        reason=forms.required(form, "reason"),
        by=person.name,
    )
    return RedirectResponse(f"/extensions?given={count}", 303)


async def save_of_person(database: Db, form: FormData, slug: str, name: str, by: str) -> bool:
    """Give a person the deadline of a form, with its reason, or with an empty one remove the extension.
    Return whether the person has an extension now.

    Raises Problem 422 for a past deadline, without a reason, for a person who is not in the course, and if
    there is no extension to remove.
    """
    due = form_times.moment(form, "due")
    if due is None:
        if not await deadlines.remove_extension(database, slug, name, by):
            detail = f"{name or 'this person'} has no extension to remove: enter a deadline to give one"
            raise Problem(422, "invalid-request", detail, "/due")
        return False
    form_times.refuse_past(due)
    if not await deadlines.extend(database, slug, name, due, reason=forms.required(form, "reason"), by=by):
        detail = f"no person named {name!r} in the course: check the name"
        raise Problem(422, "invalid-request", detail, "/name")
    return True


async def _students(database: Db) -> list[Row]:
    return [one for one in await people.everybody(database) if one.role == "student"]


def _chosen(form: FormData, students: Sequence[Row]) -> list[str]:
    """Return the login names of the students that a form chooses."""
    who = forms.field(form, "who")
    if who == EVERYBODY:
        return [one.name for one in students]
    if who.startswith(SECTION):
        return [one.name for one in students if one.section == who.removeprefix(SECTION)]
    lines = [" ".join(line.split()) for line in forms.raw_field(form, "names", MOST_NAMES).splitlines()]
    found = {line: _matching(line, students) for line in lines if line}
    if not found:
        raise Problem(422, "invalid-request", "enter the students, one on each line", "/names")
    unclear = [
        f"{line[:80]} ({'nobody' if not names else ' or '.join(names[:MOST_NAMED])})"
        for line, names in found.items()
        if len(names) != 1
    ]
    if unclear:
        listed = ", ".join(unclear[:MOST_NAMED])
        detail = f"each line must be one student; not one are {listed}: enter login names"
        raise Problem(422, "invalid-request", detail, "/names")
    return [names[0] for names in found.values()]


def _matching(text: str, students: Sequence[Row]) -> list[str]:
    """Return the login name that is the text, or those of all students with this full name, email address or
    student ID, in any case.
    """
    if any(one.name == text for one in students):
        return [text]
    wanted = text.casefold()
    return [
        one.name
        for one in students
        if any(wanted == own.casefold() for own in (one.name, one.full_name, one.email, one.student_id))
    ]
