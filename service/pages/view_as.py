"""See the pages as a student does: the staff as themselves in a student's role, or as one student."""

from urllib.parse import quote

from fastapi import APIRouter, Response
from fastapi.responses import RedirectResponse

from service.auth import forms
from service.auth.roles import OptionalUser, Staff
from service.auth.sessions import BrowserCookies
from service.http.errors import Problem
from service.http.state import Db
from service.store.course import audit
from service.store.people import people

router = APIRouter()


@router.post("/view")
async def start(person: Staff, form: forms.Form, database: Db, cookies: BrowserCookies) -> Response:
    """Show the pages from now on as the student ``name`` sees them; without a name, as a student does who
    has submitted what the member of the staff has.
    """
    if name := forms.field(form, "name"):
        found = await people.find(database, name)
        if found is None or found.role not in ("student", "former"):
            raise Problem(422, "invalid-request", f"no student named {name[:80]}: see People", "/name")
        async with database.begin() as connection:
            await audit.record(connection, person.name, "view as", name, {})
    response = RedirectResponse("/", 303)
    cookies.view_as(response, person.name, name or person.name)
    return response


@router.post("/view/stop")
async def stop(origin: forms.SameOrigin, person: OptionalUser, cookies: BrowserCookies) -> Response:
    """Show the pages again as to the staff. As that of the log-out, the form is in every page and has no
    token.
    """
    viewed = person.name if person is not None and person.views_another else ""
    response = RedirectResponse(f"/person?name={quote(viewed, safe='')}" if viewed else "/", 303)
    cookies.stop_viewing(response)
    return response
