"""The account page: name, role, password, browser sessions and tokens."""

import uuid

from fastapi import APIRouter, Request, Response
from fastapi.responses import HTMLResponse, RedirectResponse

from service.auth import cookies, passwords
from service.auth.forms import Form, field, raw_field
from service.auth.identity import LOCAL, Person
from service.auth.passwords import PasswordChecker
from service.auth.rate_limit import BY_NAME, LoginRateLimiter
from service.auth.roles import CurrentUser
from service.http.errors import Problem
from service.http.state import Config, Db, Held
from service.http.templating import templates
from service.pages.rejected_forms import post_form
from service.settings import Settings
from service.store.course import audit
from service.store.people import credentials, people, tokens

router = APIRouter()
DONE = {
    "password": "Password saved. Other browsers are logged out.",
    "revoked": "Access revoked.",
    "connected": "Account connected. You can now log in with it.",
}


@router.get("/account", response_class=HTMLResponse)
async def show(
    request: Request, person: CurrentUser, settings: Config, database: Db, done: str = ""
) -> Response:
    """Show the account page. Nobody else sees a person's sessions and tokens on it."""
    if person.views_another:
        raise Problem(403, "not-allowed", f"only {person.name} can see this page: press Stop first")
    return await _page(request, person, settings, database, done=DONE.get(done))


@post_form(router, "/account/password", page=show, at="/account")
async def set_password(
    person: CurrentUser,
    form: Form,
    database: Db,
    checker: Held[PasswordChecker],
    limits: Held[LoginRateLimiter],
) -> Response:
    """Set or change the password and log out every other browser. A change needs the current password."""
    _check_account(person)
    await _check_current_password(database, checker, limits, person.name, raw_field(form, "present"))
    stored = await checker.hash(new_password(form, person.name))
    async with database.begin() as connection:
        # the proxy may name a person that the course does not know yet
        await people.add_person(connection, person.name)
        await credentials.set_password(connection, person.name, stored, by=person.name, but=person.session)
    return RedirectResponse("/account?done=password", 303)


@post_form(router, "/account/revoke", page=show, at="/account")
async def revoke(person: CurrentUser, form: Form, database: Db) -> Response:
    """Revoke one token or session of the person."""
    _check_account(person)
    try:
        id = uuid.UUID(field(form, "id"))
    except ValueError:
        raise Problem(
            422,
            "invalid-request",
            "id must be the id of a token or session: reload the page and try again",
            "/id",
        ) from None
    async with database.begin() as connection:
        if not await tokens.revoke_own(connection, person.name, id):
            raise Problem(
                404,
                "not-found",
                "no active token or session with this id: it was revoked or has expired, reload the page",
            )
        await audit.record(connection, person.name, "revoke token", str(id), {"count": 1})
    return RedirectResponse("/account?done=revoked", 303)


@post_form(router, "/account/logout-everywhere", page=show, at="/account")
async def logout_everywhere(person: CurrentUser, form: Form, database: Db) -> Response:
    """End the person's sessions in all browsers."""
    _check_account(person)
    async with database.begin() as connection:
        count = await tokens.end_sessions(connection, person.name)
        await audit.record(connection, person.name, "log out everywhere", person.name, {"count": count})
    return cookies.clear_session(RedirectResponse("/login?out=1", 303))


def _check_account(person: Person) -> None:
    """Raise Problem 403 in single-user mode."""
    if person.single_user:
        raise Problem(
            403, "not-allowed", "this server runs in single-user mode: there are no accounts to change"
        )


async def _check_current_password(
    database: Db, checker: PasswordChecker, limits: LoginRateLimiter, name: str, password: str
) -> None:
    if await credentials.password(database, name) is None:
        return
    with limits.guard((BY_NAME, "present", name)):
        try:
            await checker.check(name, password)
        except Problem as problem:
            if problem.status == 401:
                raise Problem(401, "nobody", "the current password is wrong: try again", "/present") from None
            raise


def new_login_name(form: Form) -> str:
    """Return the login name of a new person in a form. Raises Problem 422 if it is not valid."""
    try:
        name = people.normalize_name(field(form, "name"))
    except people.InvalidName as error:
        raise Problem(422, "invalid-request", f"{error}: enter one", "/name") from None
    if name == LOCAL:
        detail = f"the name {LOCAL} is polhode's own: enter another one"
        raise Problem(422, "invalid-request", detail, "/name")
    return name


def new_password(form: Form, name: str) -> str:
    """Return the new password of the person ``name``, which the form has twice. Raises Problem 422 if it
    cannot be set.
    """
    password = raw_field(form, "password")
    if password != raw_field(form, "again"):
        raise Problem(422, "invalid-request", "passwords do not match: type the new password again", "/again")
    try:
        return passwords.normalize(password, name)
    except passwords.InvalidPassword as error:
        raise Problem(422, "invalid-request", str(error), "/password") from None


async def _page(
    request: Request, person: Person, settings: Settings, database: Db, done: str | None = None
) -> Response:
    about, rows = None, []
    if not person.single_user:
        about = await credentials.about(database, person.name)
        rows = [
            row
            for row in await tokens.all_of(database, person.name)
            if not row.revoked_at and not row.expired
        ]
    context = {
        "person": person,
        "about": about,
        "sessions": [row for row in rows if row.prefix.startswith(tokens.SESSION)],
        "tokens": [row for row in rows if row.prefix.startswith(tokens.PREFIX)],
        "current": person.session,
        "provider": settings.oidc_issuer and settings.oidc_name,
        "shortest": passwords.SHORTEST,
        "longest": passwords.LONGEST,
        "done": done,
    }
    return templates.TemplateResponse(request, "account.html", context)
