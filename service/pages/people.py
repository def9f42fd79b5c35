"""People: the list, the roster import with its preview, a person's page, and the search."""

import asyncio
from typing import Annotated, Any
from urllib.parse import quote

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response
from starlette.datastructures import FormData

from exercises.authoring.assignments.catalogue import assignments
from service.auth import forms
from service.auth.identity import Person
from service.auth.roles import Instructor, Staff
from service.formats.grade_row import total_percent
from service.formats.spreadsheet_csv import table
from service.http.errors import Problem
from service.http.requests import identifier
from service.http.state import Db
from service.http.templating import templates
from service.pages.regrades import check_labels
from service.pages.rejected_forms import post_form
from service.store.course import audit, deadlines, overrides
from service.store.course.grades import grades
from service.store.database import Row
from service.store.people import notes, people, roster, tokens
from service.store.submissions.records import recent

router = APIRouter()
PersonName = Annotated[str, Query(max_length=people.LONGEST_NAME)]
TOKEN_S = 200.0 * tokens.DAY_S
MOST_PEOPLE, MOST_SUBMISSIONS, MOST_FOUND, MOST_NAMED = 5000, 500, 50, 20


@router.get("/people", response_class=HTMLResponse)
async def show_people(
    request: Request, person: Staff, database: Db, entered: Annotated[int | None, Query(ge=0)] = None
) -> Response:
    """Show all people of the course, and to instructors the roster import."""
    rows = await people.everybody(database)
    sections = sorted({row.section for row in rows if row.section})
    context = {"rows": rows, "imported": entered, "roles": people.ROLES, "sections": sections}
    return templates.TemplateResponse(request, "people.html", context)


@post_form(router, "/people/preview", page=show_people, at="/people")
async def preview_roster(request: Request, person: Instructor, form: forms.Form, database: Db) -> Response:
    """Show what the import of a roster would add and change."""
    file, content, found = await _roster(form, person)
    known = {row.name: row for row in await people.everybody(database)}
    context = {
        "file": file,
        "content": content,
        "found": found,
        "entries": [(entry, *_change(entry, known.get(entry.name))) for entry in found.entries],
        "absent": [
            row
            for row in known.values()
            if row.role == "student" and row.name not in {e.name for e in found.entries}
        ],
        "tokens": forms.field(form, "tokens"),
        "most_named": MOST_NAMED,
    }
    return templates.TemplateResponse(request, "roster.html", context)


@post_form(router, "/people", page=show_people, at="/people")
async def import_roster(person: Instructor, form: forms.Form, database: Db) -> Response:
    """Import people from a roster. Return their new tokens as a CSV file if requested."""
    file, _, found = await _roster(form, person)
    names = [entry.name for entry in found.entries] if forms.field(form, "tokens") else []
    async with database.begin() as connection:
        await people.enroll(connection, found.entries)
        options: dict[str, Any] = {
            "label": "issued with the roster",
            "scopes": tokens.SCOPES,
            "seconds": TOKEN_S,
        }
        created = await tokens.create_all(connection, names, **options) if names else []
        await audit.record(
            connection, person.name, "roster", file, {"people": len(found.entries), "tokens": len(created)}
        )
    return (
        _tokens_file(created) if created else RedirectResponse(f"/people?entered={len(found.entries)}", 303)
    )


async def _roster(form: FormData, person: Person) -> tuple[str, str, roster.Roster]:
    """Return name, text and entries of the roster in a form: an uploaded file, or the text that a preview
    repeats.

    Raises Problem 422 if it is not valid.
    """
    if text := forms.raw_field(form, "content", forms.MOST_FORM):
        file, content = forms.field(form, "file") or "the file", text.encode()
    else:
        file, content = await forms.file(form, "roster")
    try:
        found = await asyncio.to_thread(roster.read, content, file, forms.field(form, "login") or None)
    except roster.BadRoster as error:
        raise Problem(422, "invalid-request", str(error), "/roster") from None
    if len(found.entries) > MOST_PEOPLE:
        raise Problem(
            422,
            "invalid-request",
            f"the roster has more than {MOST_PEOPLE} people: split the file",
            "/roster",
        )
    if not person.single_user and any(
        e.name == person.name and e.role not in (None, "instructor") for e in found.entries
    ):
        detail = (
            "this roster would remove your own instructor role, so nothing was imported: correct your line"
        )
        raise Problem(422, "invalid-request", detail, "/roster")
    return file, text or roster.text(content), found


def _change(entry: roster.Entry, known: Row | None) -> tuple[str, dict[str, tuple[str, str]]]:
    """Return "new", "changed" or "unchanged", and of a known person the old and the new value of each changed
    column.
    """
    if known is None:
        return "new", {}
    pairs = {column: (getattr(known, column), getattr(entry, column)) for column in people.ROSTER[1:]}
    changed = {column: (old, new) for column, (old, new) in pairs.items() if new is not None and new != old}
    return "changed" if changed else "unchanged", changed


def _tokens_file(created: list[tuple[str, str]]) -> Response:
    headers = {"Content-Disposition": 'attachment; filename="tokens.csv"'}
    return Response(table(("name", "token"), created), media_type="text/csv; charset=utf-8", headers=headers)


@router.get("/person", response_class=HTMLResponse)
async def show_person(
    request: Request,
    person: Staff,
    database: Db,
    name: PersonName = "",
) -> Response:
    """Show a person's assignments, submissions, extensions and overrides."""
    if not name:
        return RedirectResponse("/people", 303)
    about = await find_person(database, name)
    counted = {
        row.assignment: row for row in await grades(database, person=name) if row.assignment in assignments()
    }
    sent = await recent(database, MOST_SUBMISSIONS, name)
    context = {
        "about": about,
        "beside": await people.neighbours(database, name),
        "roles": people.ROLES,
        "assignments": assignments(),
        "rows": [
            (row, counted[row.slug])
            for row in await deadlines.of_person(database, name)
            if row.slug in counted
        ],
        "total": total_percent(counted.values(), graded=True),
        "notes": await notes.of_person(database, name),
        "submissions": sent,
        "most": MOST_SUBMISSIONS,
        "overrides": await overrides.of_person(database, name),
        "labels": {a.slug: check_labels(a) for a in assignments().values()},
    }
    return templates.TemplateResponse(request, "person.html", context)


@post_form(router, "/person/notes", page=show_person, at="/person")
async def write_note(person: Staff, form: forms.Form, database: Db, name: PersonName) -> Response:
    """Add a note on a person, or remove the one whose id is in ``remove``."""
    await find_person(database, name)
    if removed := forms.field(form, "remove"):
        if not await notes.remove(database, name, identifier(removed), person.name):
            raise Problem(404, "not-found", "no note with this id: reload the page")
    else:
        await notes.write(database, name, forms.required(form, "note", notes.LONGEST), person.name)
    return RedirectResponse(f"/person?name={quote(name, safe='')}#notes", 303)


async def find_person(database: Db, name: str) -> Row:
    """Return the person of that name. Raises Problem 404 if they are not in the course."""
    found = None if "\x00" in name else await people.find(database, name)
    if found is None:
        raise Problem(404, "not-found", f"no person named {name[:80]} in the course: see People")
    return found


@router.get("/search", response_class=HTMLResponse)
async def search(
    request: Request, person: Staff, database: Db, q: Annotated[str, Query(max_length=200)] = ""
) -> Response:
    """Show the people, assignments and submissions that match a text."""
    text = q.replace("\x00", "").strip()
    folded = text.casefold()
    context = {
        "text": text,
        "most": MOST_FOUND,
        "people": await people.search(database, text, MOST_FOUND) if text else [],
        "submissions": await recent(database, MOST_FOUND, text=folded) if text else [],
        "found": [a for a in assignments().values() if text and folded in f"{a.slug}\n{a.title}".casefold()],
        "assignments": assignments(),
    }
    return templates.TemplateResponse(request, "search.html", context)
