"""People: the list, a person's page, and the search."""

from collections import Counter
from math import ceil
from typing import Annotated
from urllib.parse import quote

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response

from exercises.authoring.assignments.catalogue import assignments
from service.auth import forms
from service.auth.roles import Staff
from service.formats.grade_row import total_percent
from service.http.errors import Problem
from service.http.requests import identifier
from service.http.state import Db
from service.http.templating import templates
from service.pages.regrades import check_labels
from service.pages.rejected_forms import post_form
from service.store.course import deadlines, overrides
from service.store.course.grades import grades
from service.store.database import Row
from service.store.people import notes, people
from service.store.submissions.records import recent

router = APIRouter()
PersonName = Annotated[str, Query(max_length=people.LONGEST_NAME)]
MOST_PEOPLE, MOST_SUBMISSIONS, MOST_FOUND = 1000, 500, 50


@router.get("/people", response_class=HTMLResponse)
async def show_people(
    request: Request,
    person: Staff,
    database: Db,
    entered: Annotated[int | None, Query(ge=0)] = None,
    page: Annotated[int, Query(ge=1, le=10**6)] = 1,
) -> Response:
    """Show the people of the course, so many a page, and to instructors the roster import."""
    everybody = await people.everybody(database)
    context = {
        "rows": everybody[(page - 1) * MOST_PEOPLE : page * MOST_PEOPLE],
        "roles": Counter(one.role for one in everybody),
        "page": page,
        "pages": max(1, ceil(len(everybody) / MOST_PEOPLE)),
        "imported": entered,
    }
    return templates.TemplateResponse(request, "people.html", context)


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
    overridden = await overrides.of_person(database, name)
    changed = [known for one in overridden if (known := assignments().get(one.assignment))]
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
        "overrides": overridden,
        "labels": {one.slug: check_labels(one) for one in changed},
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
    return RedirectResponse(f"{page_of(name)}#notes", 303)


def page_of(name: str) -> str:
    """Return the path of a person's page."""
    return f"/person?name={quote(name, safe='')}"


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
