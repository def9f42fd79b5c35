"""The first instructor of a course, created with the link that the server prints."""

from fastapi import APIRouter, Request, Response
from fastapi.responses import HTMLResponse, RedirectResponse

from service.auth import forms, passwords
from service.auth.cookies import BrowserCookies
from service.auth.identity import Person
from service.auth.passwords import PasswordChecker
from service.auth.roles import OptionalUser
from service.http.errors import Problem
from service.http.state import Db, Held
from service.http.templating import templates
from service.pages import account
from service.pages.rejected_forms import post_form
from service.settings import Settings
from service.store.people import first_instructor, people

router = APIRouter()


@router.get("/start", response_class=HTMLResponse)
async def show_start(
    request: Request,
    person: OptionalUser,
    database: Db,
    cookies: BrowserCookies,
    settings: Held[Settings],
) -> Response:
    """Show the form that creates the first instructor; lead to the set-up page once there is one."""
    if not await first_instructor.is_needed(database, single_user=settings.is_single_user):
        return RedirectResponse("/setup", 303)
    context = {
        "known": _logged_in(person),
        "shortest": passwords.SHORTEST,
        "longest": passwords.LONGEST,
        "longest_name": people.LONGEST_NAME,
    }
    response = templates.TemplateResponse(request, "start.html", context)
    cookies.store_anonymous_id(response)
    return response


@post_form(router, "/start", page=show_start, at="/start")
async def start(
    form: forms.PublicForm,
    person: OptionalUser,
    database: Db,
    cookies: BrowserCookies,
    checker: Held[PasswordChecker],
    settings: Held[Settings],
) -> Response:
    """Create the first instructor and log them in. Who is logged in already becomes it themselves."""
    secret = forms.required(form, "token")
    known, full_name, password = _logged_in(person), None, None
    if known is not None:
        known.with_scope("login")
    name = known.name if known else account.new_login_name(form)
    if not await first_instructor.is_link(database, secret):
        raise _not_the_link()  # before the password is hashed, which takes a second
    if known is None:
        full_name = forms.field(form, "full_name", people.LONGEST_NAME)
        password = await checker.hash(account.new_password(form, name))
    try:
        async with database.begin() as connection:
            await first_instructor.create(
                connection, secret, name, full_name, password, single_user=settings.is_single_user
            )
    except first_instructor.LinkOver:
        raise _not_the_link() from None
    response = RedirectResponse("/setup", 303)
    if known is None:
        await cookies.start_session(response, name, "the first link")
    return response


def _not_the_link() -> Problem:
    detail = "this is not the link that the server printed, or it was used: copy the whole of it"
    return Problem(403, "not-allowed", detail, "/token")


def _logged_in(person: Person | None) -> Person | None:
    """Return the person unless they are the one that all visitors of a server without logins are."""
    return None if person is None or person.single_user else person
