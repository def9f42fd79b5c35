"""The import of a roster: a preview with the columns and what is unclear, and the import."""

import asyncio
import base64
from typing import Any

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response
from starlette.datastructures import FormData

from service.auth import forms
from service.auth.identity import Person
from service.auth.roles import Instructor
from service.formats.spreadsheet_csv import table
from service.http.errors import Problem, wants_page
from service.http.state import Db
from service.http.templating import templates
from service.pages.people.listing import show_people
from service.pages.rejected_forms import post_form
from service.store.people import people, tokens
from service.store.people.people import ROLES
from service.store.people.roster.columns import BEFORE_AT, FIELDS
from service.store.people.roster.importing import Plan, carry_out, compare
from service.store.people.roster.problems import MOST_SHOWN, BadRoster, shortened
from service.store.people.roster.reading import SKIP, Choices, Roster, read
from service.store.people.roster.text import ENCODINGS

router = APIRouter()
MOST_PEOPLE, MOST_ROWS = 10_000, 500
COLUMN, ROLE = "column:", "role:"
"""What the names of fields begin with that choose the column of a field, or the role that a word means."""


@post_form(router, "/people/preview", page=show_people, at="/people")
async def preview_roster(request: Request, person: Instructor, form: forms.Form, database: Db) -> Response:
    """Show what the import of a roster would add and change, and what must be confirmed or corrected."""
    content, roster = await _read(form)
    return await _preview(request, form, content, await compare(database, roster, _importer(person)))


@post_form(router, "/people", page=show_people, at="/people")
async def import_roster(request: Request, person: Instructor, form: forms.Form, database: Db) -> Response:
    """Import people from a roster. Return their new tokens as a CSV file if requested.

    What is unclear must be confirmed; else the preview is shown again.
    """
    content, roster = await _read(form)
    created: list[tuple[str, str]] = []
    async with database.begin() as connection:
        await people.lock_members(connection)
        plan = await compare(connection, roster, _importer(person))
        if not (unclear := _unclear(form, plan)):
            token_s = tokens.TERM_DAYS * tokens.DAY_S if forms.field(form, "tokens") else None
            created = await carry_out(connection, plan, person.name, token_s)
    if unclear:
        if not wants_page(request):
            raise Problem(422, "invalid-request", unclear, "/roster")
        return await _preview(request, form, content, plan, unclear)
    if created:
        headers = {"Content-Disposition": 'attachment; filename="tokens.csv"'}
        return Response(
            table(("name", "token"), created), media_type="text/csv; charset=utf-8", headers=headers
        )
    return RedirectResponse(f"/people?entered={len(plan.changes)}", 303)


async def _file(form: FormData) -> tuple[str, bytes]:
    """Return name and content of the roster in a form: an uploaded file, or what a preview repeats."""
    if not (repeated := forms.raw_field(form, "content", forms.MOST_FORM)):
        return await forms.file(form, "roster")
    try:
        return forms.field(form, "file") or "the file", base64.b64decode(repeated, validate=True)
    except ValueError:  # binascii.Error, or text that is not ASCII
        raise Problem(
            422, "invalid-request", "the file was changed on its way: choose it again", "/roster"
        ) from None


async def _read(form: FormData) -> tuple[bytes, Roster]:
    """Return the file in a form, and its roster. Raises Problem 422 if it is none."""
    file, content = await _file(form)
    try:
        found = await asyncio.to_thread(read, content, file, _choices(form))
    except BadRoster as error:
        raise Problem(422, "invalid-request", str(error), "/roster") from None
    if len(found.entries) > MOST_PEOPLE:
        detail = f"the roster has more than {MOST_PEOPLE} people: split the file"
        raise Problem(422, "invalid-request", detail, "/roster")
    return content, found


def _importer(person: Person) -> str | None:
    """Return the name of the instructor who imports, None if everybody is one."""
    return None if person.single_user else person.name


def _choices(form: FormData) -> Choices:
    """Return what was chosen on a preview."""
    chosen = {name: forms.raw_field(form, name) for name in form if name.startswith((COLUMN, ROLE))}
    return Choices(
        {name.removeprefix(COLUMN): value for name, value in chosen.items() if name.startswith(COLUMN)},
        {name.removeprefix(ROLE): value for name, value in chosen.items() if name.startswith(ROLE)},
        forms.field(form, "encoding") or None,
    )


def _unclear(form: FormData, plan: Plan) -> str:
    """Return why the roster cannot be imported as it is, or ""."""
    if plan.errors:
        return f"nothing was imported: {'; '.join(shortened(plan.errors))}"
    if plan.open_questions(_confirmed(form)):
        return "nothing was imported: confirm each point, or correct the file"
    return ""


def _confirmed(form: FormData) -> set[str]:
    return {key for key in form.getlist("confirmed") if isinstance(key, str)}


async def _preview(
    request: Request, form: FormData, content: bytes, plan: Plan, unclear: str = ""
) -> HTMLResponse:
    context: dict[str, Any] = {
        "plan": plan,
        "file": plan.roster.file,
        "content": base64.b64encode(content).decode(),
        "columns": plan.roster.columns,
        "chosen": _choices(form),
        "fields": FIELDS,
        "roles": (SKIP, *ROLES),
        "encodings": ENCODINGS,
        "before_at": BEFORE_AT,
        "unclear": unclear,
        "confirmed": _confirmed(form),
        "tokens": forms.field(form, "tokens"),
        "most_named": MOST_SHOWN,
        "shortened": shortened,
        "most_rows": MOST_ROWS,
    }
    return templates.TemplateResponse(request, "roster.html", context, status_code=422 if unclear else 200)
