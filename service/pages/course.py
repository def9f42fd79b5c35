"""The first page: for staff the course with what waits to be done, for a student their own submissions."""

from typing import Annotated, Any

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response

from exercises.catalogue import assignments
from service.auth import forms
from service.auth.identity import STAFF
from service.auth.roles import CurrentUser, Instructor, Staff
from service.formats.csv import table
from service.http.errors import Problem
from service.http.templating import templates
from service.store.course import gradebook, people, tokens
from service.store.course.audit import MOST, entries
from service.store.records import recent

router = APIRouter()
LATEST = 100


@router.get("/", response_class=HTMLResponse)
async def index(request: Request, person: CurrentUser) -> Response:
    """The assignments with their totals, and the latest submissions, of everybody or your own."""
    database, everybody = request.app.state.database, request.state.role in STAFF
    isolation, refusal = await request.app.state.crew.known()
    context = {
        "everybody": everybody,
        "rows": await recent(database, LATEST, None if everybody else person.name),
        "assignments": assignments(),
        "overview": await gradebook.overview(database),
        "isolation": isolation or refusal or "none",
    }
    return templates.TemplateResponse(request, "index.html", context)


TOKEN_S = 200.0 * tokens.DAY_S
MOST_PEOPLE = 5000


@router.get("/people", response_class=HTMLResponse)
async def show_people(request: Request, person: Staff, entered: Annotated[int | None, Query(ge=0)] = None) -> Response:
    """Everybody in the course; for instructors also the form that takes a roster."""
    rows = await people.everybody(request.app.state.database)
    return templates.TemplateResponse(request, "people.html", {"rows": rows, "entered": entered, "columns": people.COLUMNS})


@router.post("/people")
async def enter(request: Request, person: Instructor, form: forms.Form) -> Response:
    """Enter the people of a CSV file; where tokens are wanted, the answer is a CSV file of them."""
    file, content = await forms.file(form, "roster")
    try:
        entries = people.read(content, file)
    except people.BadRoster as error:
        raise Problem(422, "invalid-request", str(error), "/roster") from None
    if len(entries) > MOST_PEOPLE:
        raise Problem(422, "invalid-request", f"a roster has at most {MOST_PEOPLE} people", "/roster")
    if any(entry.name == person.name and entry.role not in (None, "instructor") for entry in entries) and not person.alone:
        raise Problem(
            422, "invalid-request", "this roster would make you no instructor any more: nobody has been entered", "/roster"
        )
    names = [entry.name for entry in entries] if forms.field(form, "tokens") else []
    async with request.app.state.database.begin() as connection:
        await people.enroll(connection, entries)
        terms: dict[str, Any] = {"label": "given by roster", "scopes": tokens.SCOPES, "seconds": TOKEN_S}
        given = await tokens.create_all(connection, names, **terms) if names else []
        await people.record_audit(connection, person.name, "roster", file, {"people": len(entries), "tokens": len(given)})
    return _file(given) if given else RedirectResponse(f"/people?entered={len(entries)}", 303)


def _file(given: list[tuple[str, str]]) -> Response:
    headers = {"Content-Disposition": 'attachment; filename="tokens.csv"'}
    return Response(table(("name", "token"), given), media_type="text/csv; charset=utf-8", headers=headers)


@router.get("/audit", response_class=HTMLResponse)
async def page(
    request: Request,
    person: Staff,
    subject: Annotated[str, Query(max_length=200)] = "",
    before: Annotated[int | None, Query(ge=0, le=2**62)] = None,
) -> Response:
    """The latest entries, of all or about one subject or person."""
    subject = subject.strip().replace("\x00", "")
    rows = await entries(request.app.state.database, subject or None, before)
    context = {"rows": rows, "subject": subject, "older": rows[-1].id if len(rows) == MOST else None}
    return templates.TemplateResponse(request, "audit.html", context)
