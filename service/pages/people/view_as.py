"""See the pages as a student does: the staff as themselves in a student's role, or as one student."""

from fastapi import APIRouter, Response
from fastapi.responses import RedirectResponse

from service.auth import forms
from service.auth.cookies import BrowserCookies
from service.auth.roles import OptionalUser, Staff
from service.http.errors import Problem
from service.http.state import Db
from service.pages.course import home, setup
from service.pages.people.listing import PersonName, find_person, page_of, show_person
from service.pages.rejected_forms import post_form
from service.store.course import audit

router = APIRouter()


@post_form(router, "/view", page=home.index, at="/")
@post_form(router, "/setup/view", page=setup.show, at="/setup")
async def as_a_student(person: Staff, form: forms.Form, cookies: BrowserCookies) -> Response:
    """Show the pages from now on as to a student who has submitted what the member of the staff has."""
    response = RedirectResponse("/", 303)
    cookies.view_as(response, person.name, person.name)
    return response


@post_form(router, "/person/view", page=show_person, at="/person")
async def as_one_student(
    person: Staff, form: forms.Form, database: Db, cookies: BrowserCookies, name: PersonName
) -> Response:
    """Show the pages from now on as the student ``name`` sees them."""
    if (await find_person(database, name)).role not in ("student", "former"):
        raise Problem(422, "invalid-request", f"{name} is not a student: choose one")
    async with database.begin() as connection:
        await audit.record(connection, person.name, "view as", name, {})
    response = RedirectResponse("/", 303)
    cookies.view_as(response, person.name, name)
    return response


@router.post("/view/stop")
async def stop(origin: forms.SameOrigin, person: OptionalUser, cookies: BrowserCookies) -> Response:
    """Show the pages again as to the staff. As that of the log-out, the form is in every page and has no
    token.
    """
    viewed = person.name if person is not None and person.views_another else ""
    response = RedirectResponse(page_of(viewed) if viewed else "/", 303)
    cookies.stop_viewing(response)
    return response
