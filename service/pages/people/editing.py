"""Add and edit a person, give them a new token or password, and more time for an assignment."""

import secrets

from fastapi import APIRouter, Request, Response
from fastapi.responses import HTMLResponse, RedirectResponse
from starlette.datastructures import FormData

from exercises.authoring.assignments.catalogue import assignments
from service.auth import forms
from service.auth.passwords import PasswordChecker
from service.auth.roles import Instructor
from service.http.errors import Problem
from service.http.requests import PublicAddress
from service.http.state import Db, Held
from service.http.templating import templates
from service.pages import account
from service.pages.people import extensions
from service.pages.people.listing import PersonName, find_person, page_of, show_person
from service.pages.rejected_forms import post_form
from service.store.course import audit
from service.store.database import Connection
from service.store.people import credentials, editing, people, tokens

router = APIRouter()
LABELS = {
    "role": "role",
    "full_name": "full name",
    "email": "email",
    "student_id": "student ID",
    "section": "section",
}
LONGEST = 200


@router.get("/people/add", response_class=HTMLResponse)
async def show_add(request: Request, person: Instructor, database: Db) -> Response:
    """Show the form that adds a person."""
    sections = sorted({one.section for one in await people.everybody(database) if one.section})
    context = {"roles": people.ROLES, "sections": sections}
    return templates.TemplateResponse(request, "add_person.html", context)


@post_form(router, "/people/add", page=show_add, at="/people/add")
async def add(
    request: Request, person: Instructor, form: forms.Form, database: Db, address: PublicAddress
) -> Response:
    """Add a person; show their new token if the form asks for one."""
    name = account.new_login_name(form)
    values = _values(form)
    token = None
    try:
        async with database.begin() as connection:
            await editing.add(connection, name, values, person.name)
            if forms.field(form, "token"):
                token = await _new_token(connection, name, person.name)
    except editing.KnownPerson:
        detail = f"{name} is in the course already: see the list, and edit the person there"
        raise Problem(422, "invalid-request", detail, "/name") from None
    if token is not None:
        return _show_secret(request, name, address, token=token)
    return RedirectResponse(page_of(name), 303)


@post_form(router, "/person/edit", page=show_person, at="/person")
async def edit(person: Instructor, form: forms.Form, database: Db, name: PersonName) -> Response:
    """Change role, full name, email, student ID and section of a person.

    If somebody else has changed the person meanwhile, nothing is saved, and the form says what they changed.
    """
    await find_person(database, name)
    values = _values(form)
    seen = {field: forms.raw_field(form, f"seen-{field}") for field in editing.FIELDS}
    try:
        async with database.begin() as connection:
            await editing.change(connection, name, values, seen, person.name)
    except editing.ChangedMeanwhile as meanwhile:
        raise Problem(409, "changed-meanwhile", _told(meanwhile)) from None
    except editing.LastInstructor:
        detail = f"{name} is the only instructor: make somebody else an instructor first"
        raise Problem(422, "invalid-request", detail, "/role") from None
    return RedirectResponse(page_of(name), 303)


@post_form(router, "/person/token", page=show_person, at="/person")
async def give_token(
    request: Request,
    person: Instructor,
    form: forms.Form,
    database: Db,
    name: PersonName,
    address: PublicAddress,
) -> Response:
    """Revoke all tokens and sessions of a person, and show a new token."""
    await find_person(database, name)
    async with database.begin() as connection:
        await tokens.revoke(connection, person=name)
        token = await _new_token(connection, name, person.name)
    return _show_secret(request, name, address, token=token)


@post_form(router, "/person/password", page=show_person, at="/person")
async def give_password(
    request: Request,
    person: Instructor,
    form: forms.Form,
    database: Db,
    name: PersonName,
    checker: Held[PasswordChecker],
    address: PublicAddress,
) -> Response:
    """End a person's sessions, and show a new password that they can change."""
    await find_person(database, name)
    password = secrets.token_urlsafe(12)
    stored = await checker.hash(password)
    async with database.begin() as connection:
        await credentials.set_password(connection, name, stored, by=person.name)
    return _show_secret(request, name, address, password=password)


@post_form(router, "/person/extensions", page=show_person, at="/person")
async def extend(person: Instructor, form: forms.Form, database: Db, name: PersonName) -> Response:
    """Give a person a later deadline of an assignment. An empty deadline removes the extension."""
    await find_person(database, name)
    slug = forms.field(form, "assignment")
    if slug not in assignments():
        raise Problem(422, "invalid-request", "choose an assignment", "/assignment")
    await extensions.save_of_person(database, form, slug, name, person.name)
    return RedirectResponse(f"{page_of(name)}#assignments", 303)


def _values(form: FormData) -> dict[str, str]:
    """Return the fields of a person in a form, each with single spaces. Raises Problem 422 if one is not
    valid.
    """
    values = {field: " ".join(forms.field(form, field, LONGEST).split()) for field in editing.FIELDS}
    for field, value in values.items():
        if not value.isprintable():
            detail = f"the {LABELS[field]} has a character that cannot be printed: type it again"
            raise Problem(422, "invalid-request", detail, f"/{field}")
    if values["role"] not in people.ROLES:
        raise Problem(422, "invalid-request", f"choose one of {', '.join(people.ROLES)}", "/role")
    return values


def _told(meanwhile: editing.ChangedMeanwhile) -> str:
    """Return what somebody else has changed, and what to do."""
    changes = ", ".join(
        f"{LABELS[field]} from {old or 'nothing'} to {new or 'nothing'}"
        for field, (old, new) in meanwhile.changes.items()
    )
    return (
        f"not saved, because {meanwhile.by or 'somebody else'} has changed this person since you opened the"
        f" page: {changes}. What you typed is kept below: check it and save again"
    )


async def _new_token(connection: Connection, name: str, by: str) -> str:
    seconds = tokens.TERM_DAYS * tokens.DAY_S
    token = await tokens.create(
        connection, name, label=f"issued by {by}", scopes=tokens.SCOPES, seconds=seconds
    )
    await audit.record(connection, by, "give token", name, {"scopes": list(tokens.SCOPES)})
    return token


def _show_secret(
    request: Request, name: str, address: str, *, token: str = "", password: str = ""
) -> Response:
    """Return the page that shows a new token or password, which no other page can show again."""
    context = {"name": name, "address": address, "page": page_of(name), "days": round(tokens.TERM_DAYS)}
    context |= {"token": token, "password": password}
    return templates.TemplateResponse(request, "new_login.html", context)
