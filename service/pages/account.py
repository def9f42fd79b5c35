"""The page of your own account: who you are here, your password, your sessions in browsers and your tokens."""

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
from service.store.course import credentials, people, tokens

router = APIRouter()
DONE = {
    "password": "Your password is set. Other browsers are logged out.",
    "revoked": "Revoked.",
    "connected": "Your account there is connected: from now on it logs you in here.",
}


@router.get("/account", response_class=HTMLResponse)
async def show(request: Request, person: CurrentUser, done: str = "") -> Response:
    """Who you are here, and what you are logged in with."""
    return await _page(request, person, done=DONE.get(done))


@router.post("/account/password")
async def set_password(request: Request, person: CurrentUser, form: Form) -> Response:
    """Set a password, or change it for who knows the present one; every other browser is logged out."""
    await _told_apart(request)
    try:
        await _check_present(request, person.name, raw_field(form, "present"))
        kept = await request.app.state.passwords.hash(_new(form, person.name))
    except Problem as problem:
        if not wants_page(request):
            raise
        return await _page(request, person, problem)
    current = getattr(request.state, "session", None)
    async with request.app.state.database.begin() as connection:
        await people.add_person(connection, person.name)  # a proxy may have told of somebody new
        await credentials.set_password(connection, person.name, kept, by=person.name, but=current and current.id)
    return RedirectResponse("/account?done=password", 303)


@router.post("/account/revoke")
async def revoke(request: Request, person: CurrentUser, form: Form) -> Response:
    """Revoke one token of yours, or end one session."""
    await _told_apart(request)
    try:
        id = uuid.UUID(field(form, "id"))
    except ValueError:
        raise Problem(422, "invalid-request", "id is the number of a token or session", "/id") from None
    async with request.app.state.database.begin() as connection:
        if not await tokens.revoke_own(connection, person.name, id):
            raise Problem(404, "not-found", "you have no such token or session, or it is over already")
        await people.record_audit(connection, person.name, "revoke token", str(id), {"count": 1})
    return RedirectResponse("/account?done=revoked", 303)


@router.post("/account/logout-everywhere")
async def leave_everywhere(request: Request, person: CurrentUser, form: Form) -> Response:
    """End your sessions in all browsers."""
    await _told_apart(request)
    async with request.app.state.database.begin() as connection:
        count = await tokens.end_sessions(connection, person.name)
        await people.record_audit(connection, person.name, "log out everywhere", person.name, {"count": count})
    return sessions.clear_session(RedirectResponse("/login?out=1", 303))


async def _told_apart(request: Request) -> None:
    """Problem 403 for what may not change an account: a notebook's token, or the local student, who has none."""
    if (await authenticate(request, "login")).alone:
        raise Problem(403, "not-allowed", "this server knows one local student, who has no account")


async def _check_present(request: Request, name: str, present: str) -> None:
    if await credentials.password(request.app.state.database, name) is None:
        return
    with request.app.state.throttle.attempt((BY_NAME, "present", name)):
        try:
            await request.app.state.passwords.check(name, present)
        except Problem as problem:
            if problem.status == 401:
                raise Problem(401, "nobody", "the present password is wrong") from None
            raise


def _new(form: Form, name: str) -> str:
    wanted = raw_field(form, "password")
    if wanted != raw_field(form, "again"):
        raise Problem(422, "invalid-request", "the new password was not typed the same twice", "/again")
    try:
        return passwords.normalize(wanted, name)
    except passwords.InvalidPassword as error:
        raise Problem(422, "invalid-request", str(error), "/password") from None


async def _page(request: Request, person: Person, problem: Problem | None = None, done: str | None = None) -> Response:
    about, rows = None, []
    if not person.alone:
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
