"""The people of the course: a table of them, and the roster that enters them."""

from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from fastapi.responses import HTMLResponse, RedirectResponse

from service import roster
from service.grades.cells import table
from service.store import people as stored
from service.store import tokens
from service.web import forms
from service.web.problems import Problem
from service.web.roles import Instructor, Staff
from service.web.templating import templates

router = APIRouter()
TOKEN_S = 200.0 * tokens.DAY_S
MOST_PEOPLE = 5000


@router.get("/people", response_class=HTMLResponse)
async def people(request: Request, person: Staff, entered: Annotated[int | None, Query(ge=0)] = None) -> Response:
    """Everybody in the course; for instructors also the form that takes a roster."""
    rows = await stored.everybody(request.app.state.database)
    return templates.TemplateResponse(request, "people.html", {"rows": rows, "entered": entered, "columns": roster.COLUMNS})


@router.post("/people")
async def enter(request: Request, person: Instructor, form: forms.Form) -> Response:
    """Enter the people of a CSV file; where tokens are wanted, the answer is a CSV file of them."""
    file, content = await forms.file(form, "roster")
    try:
        entries = roster.read(content, file)
    except roster.BadRoster as error:
        raise Problem(422, "invalid-request", str(error), "/roster") from None
    if len(entries) > MOST_PEOPLE:
        raise Problem(422, "invalid-request", f"a roster has at most {MOST_PEOPLE} people", "/roster")
    if any(entry.name == person.name and entry.role not in (None, "instructor") for entry in entries) and not person.alone:
        raise Problem(
            422, "invalid-request", "this roster would make you no instructor any more: nobody has been entered", "/roster"
        )
    names = [entry.name for entry in entries] if forms.field(form, "tokens") else []
    async with request.app.state.database.begin() as connection:
        await stored.enroll(connection, entries)
        terms: dict[str, Any] = {"label": "given by roster", "scopes": tokens.SCOPES, "seconds": TOKEN_S}
        given = await tokens.give_all(connection, names, **terms) if names else []
        await stored.note(connection, person.name, "roster", file, {"people": len(entries), "tokens": len(given)})
    return _file(given) if given else RedirectResponse(f"/people?entered={len(entries)}", 303)


def _file(given: list[tuple[str, str]]) -> Response:
    headers = {"Content-Disposition": 'attachment; filename="tokens.csv"'}
    return Response(table(("name", "token"), given), media_type="text/csv; charset=utf-8", headers=headers)
