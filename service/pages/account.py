"""The account page: name, role, password, browser sessions and tokens."""

import uuid

from fastapi import APIRouter, Request, Response
from fastapi.responses import HTMLResponse, RedirectResponse

from service.auth import passwords, sessions
from service.auth.forms import Form, field, raw_field
from service.auth.identity import Person, authenticate
from service.auth.rate_limit import BY_NAME
from service.auth.roles import CurrentUser
from service.http.errors import Problem, wants_page
from service.http.templating import templates
from service.store.course import audit, credentials, people, tokens

router = APIRouter()
DONE = {
    "password": "Password saved. Other browsers are logged out.",
    "revoked": "Access revoked.",
    "connected": "Account connected. You can now log in with it.",
}


@router.get("/account", response_class=HTMLResponse)
async def show(request: Request, person: CurrentUser, done: str = "") -> Response:
    """Show the account page."""
    return await _page(request, person, done=DONE.get(done))


@router.post("/account/password")
async def set_password(request: Request, person: CurrentUser, form: Form) -> Response:
    """Set or change the password and log out every other browser. A change needs the current password."""
    await _check_account(request)
    try:
        await _check_current_password(request, person.name, raw_field(form, "present"))
        stored = await request.app.state.password_checker.hash(_new_password(form, person.name))
    except Problem as problem:
        if not wants_page(request):
            raise
        return await _page(request, person, problem)
    current = getattr(request.state, "session", None)
    async with request.app.state.database.begin() as connection:
        await people.add_person(connection, person.name)  # the proxy may name a person that the course does not know yet
        await credentials.set_password(connection, person.name, stored, by=person.name, but=current and current.id)
    return RedirectResponse("/account?done=password", 303)


@router.post("/account/revoke")
async def revoke(request: Request, person: CurrentUser, form: Form) -> Response:
    """Revoke one token or session of the person."""
    await _check_account(request)
    try:
        id = uuid.UUID(field(form, "id"))
    except ValueError:
        raise Problem(
            422, "invalid-request", "id must be the id of a token or session: reload the page and try again", "/id"
        ) from None
    async with request.app.state.database.begin() as connection:
        if not await tokens.revoke_own(connection, person.name, id):
            raise Problem(
                404, "not-found", "no active token or session with this id: it was revoked or has expired, reload the page"
            )
        await audit.record(connection, person.name, "revoke token", str(id), {"count": 1})
    return RedirectResponse("/account?done=revoked", 303)


@router.post("/account/logout-everywhere")
async def logout_everywhere(request: Request, person: CurrentUser, form: Form) -> Response:
    """End the person's sessions in all browsers."""
    await _check_account(request)
    async with request.app.state.database.begin() as connection:
        count = await tokens.end_sessions(connection, person.name)
        await audit.record(connection, person.name, "log out everywhere", person.name, {"count": count})
    return sessions.clear_session(RedirectResponse("/login?out=1", 303))


async def _check_account(request: Request) -> None:
    """Raise Problem 403 in single-user mode, and for a token that may not log in."""
    if (await authenticate(request, "login")).single_user:
        raise Problem(403, "not-allowed", "this server runs in single-user mode: there are no accounts to change")


async def _check_current_password(request: Request, name: str, password: str) -> None:
    if await credentials.password(request.app.state.database, name) is None:
        return
    with request.app.state.login_limiter.guard((BY_NAME, "present", name)):
        try:
            await request.app.state.password_checker.check(name, password)
        except Problem as problem:
            if problem.status == 401:
                raise Problem(401, "nobody", "the current password is wrong: try again") from None
            raise


def _new_password(form: Form, name: str) -> str:
    password = raw_field(form, "password")
    if password != raw_field(form, "again"):
        raise Problem(422, "invalid-request", "passwords do not match: type the new password again", "/again")
    try:
        return passwords.normalize(password, name)
    except passwords.InvalidPassword as error:
        raise Problem(422, "invalid-request", str(error), "/password") from None


async def _page(request: Request, person: Person, problem: Problem | None = None, done: str | None = None) -> Response:
    about, rows = None, []
    if not person.single_user:
        about = await credentials.about(request.app.state.database, person.name)
        rows = [
            row for row in await tokens.all_of(request.app.state.database, person.name) if not row.revoked_at and not row.expired
        ]
    current = getattr(request.state, "session", None)
    context = {
        "person": person,
        "about": about,
        "sessions": [row for row in rows if row.prefix.startswith(tokens.SESSION)],
        "tokens": [row for row in rows if row.prefix.startswith(tokens.PREFIX)],
        "current": current and current.id,
        "provider": request.app.state.settings.oidc_name if request.app.state.oidc else None,
        "shortest": passwords.SHORTEST,
        "longest": passwords.LONGEST,
        "error": problem and problem.detail,
        "done": done,
    }
    status, headers = (problem.status, problem.headers()) if problem else (200, {})
    return templates.TemplateResponse(request, "account.html", context, status_code=status, headers=headers)
