"""The page that leads through the set-up of a course: staff, name, assignments, students, a trial."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from fastapi import APIRouter, Request, Response
from fastapi.responses import HTMLResponse, RedirectResponse
from starlette.datastructures import FormData

from exercises.authoring.assignments.catalogue import assignments
from service.auth import forms
from service.auth.roles import Instructor, Staff
from service.http.state import Db
from service.http.templating import templates
from service.pages import form_times
from service.pages.course import settings as settings_page
from service.pages.rejected_forms import post_form
from service.store.course import assignment_settings, course_settings
from service.store.database import Row
from service.store.people import people

router = APIRouter()


@router.get("/setup", response_class=HTMLResponse)
async def show(request: Request, person: Staff, database: Db) -> Response:
    """Show what a new course needs, and what of it is done."""
    everybody = await people.everybody(database)
    rows = await settings_page.overview(database)
    context = {
        "settings": await course_settings.read(database),
        "zones": settings_page.zones(),
        "rows": rows,
        "published": sum(row.published for row in rows),
        "assignments": assignments(),
        "staff": [one for one in everybody if one.role in people.STAFF],
        "students": sum(one.role == "student" for one in everybody),
        "submitted": sum(row.submissions for row in rows),
    }
    return templates.TemplateResponse(request, "setup.html", context)


@post_form(router, "/setup/course", page=show, at="/setup")
async def name_course(person: Instructor, form: forms.Form, database: Db) -> Response:
    """Save what was changed of name, term and time zone of the course."""
    about = settings_page.about_course(form)
    about = {name: value for name, value in about.items() if form.get(f"seen-{name}") != value}
    settings = replace(await course_settings.read(database), **about)
    await course_settings.change(database, settings, {}, person.name)
    return RedirectResponse("/setup#assignments", 303)


@post_form(router, "/setup/assignments", page=show, at="/setup")
async def choose(person: Instructor, form: forms.Form, database: Db) -> Response:
    """Save what was changed of the assignments: whether they are published, and from when to when open."""
    rows = await settings_page.overview(database)
    chosen = {row.slug: _changes(form, row) for row in rows if f"due-{row.slug}" in form}
    async with database.begin() as connection:
        for slug, changes in chosen.items():
            if changes:
                await assignment_settings.change_in(connection, slug, changes, person.name)
    return RedirectResponse("/setup#people", 303)


def _changes(form: FormData, row: Row) -> dict[str, Any]:
    """Return the settings of an assignment that differ from what the form showed, so that what others have
    changed meanwhile stays.
    """
    published, available, due = fields = [f"{name}-{row.slug}" for name in ("published", "available", "due")]
    changed = _changed(form, f"seen-{row.slug}", fields)
    changes: dict[str, Any] = {}
    if published in changed:
        changes["published"] = bool(forms.field(form, published))
    if available in changed:
        changes["available_from"] = form_times.moment(form, available)
    if due in changed:
        changes["due_at"] = form_times.deadline(form, due, row.due_at)
    return changes


def _changed(form: FormData, seen: str, fields: Sequence[str]) -> set[str]:
    """Return the fields that differ from what the form showed, as its field ``seen`` has it, separated by
    bars; all of them without this field.
    """
    shown = forms.raw_field(form, seen).split("|")
    if len(shown) != len(fields):
        return set(fields)
    return {field for field, was in zip(fields, shown, strict=True) if was != forms.raw_field(form, field)}
