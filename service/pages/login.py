"""Log-in and log-out pages, and the authorization of a notebook by its code."""

from fastapi import APIRouter, Request, Response
from fastapi.responses import HTMLResponse, RedirectResponse
from starlette.datastructures import FormData

from service.auth import sessions
from service.auth.forms import PublicForm, checked_form, field, raw_field
from service.auth.identity import Person, authenticate, by_token, same_origin
from service.auth.rate_limit import keys_of
from service.auth.roles import OptionalUser
from service.http.errors import Problem, wants_page
from service.http.requests import LONGEST_PATH, local_path
from service.http.templating import templates
from service.store.course import people, tokens

router = APIRouter()


@router.get("/login", response_class=HTMLResponse)
async def login_page(request: Request, person: OptionalUser, code: str = "", next: str = "") -> Response:
    """Show the log-in page, or the authorization page for a notebook's code."""
    return await _page(request, code[:20], local_path(next[:LONGEST_PATH]))


@router.post("/login", response_class=HTMLResponse)
async def login(request: Request, form: PublicForm) -> Response:
    """Log in by password or token and redirect to the requested page, or authorize or refuse a
    notebook's code.
    """
    code, back = field(form, "code", 20), local_path(field(form, "next", LONGEST_PATH))
    try:
        name, method = await _authenticated(request, form)
        if code:
            return await _confirm(request, code, name, method, refused=bool(field(form, "refuse")))
    except Problem as problem:
        if not wants_page(request):
            raise
        return await _page(request, code, back, problem, field(form, "name"))
    response = RedirectResponse(back or "/", 303)
    if method:
        await sessions.start_session(request, response, name, method)
    return response


@router.post("/logout")
async def logout(request: Request, person: OptionalUser) -> Response:
    """End the browser's session on all servers."""
    same_origin(request)  # checked for expired sessions too, whose form has no valid token
    if person is not None:
        await checked_form(request)
        if session := getattr(request.state, "session", None):
            async with request.app.state.database.begin() as connection:
                await tokens.revoke(connection, id=session.id)
    return sessions.clear_session(RedirectResponse("/login?out=1", 303))


async def _authenticated(request: Request, form: FormData) -> tuple[str, str]:
    """Return the name and the login method, "" for an existing session. Raises Problem 401, 403 or 429."""
    token, password = field(form, "token"), raw_field(form, "password")
    if token:
        return _check_login_scope(await by_token(request, token)), "token"
    name = _normalized(field(form, "name"))
    if not name and not password:
        return _check_login_scope(await authenticate(request, "login")), ""
    with request.app.state.login_limiter.guard(*keys_of(request, name)):
        await request.app.state.password_checker.check(name, password)
    return name, "password"


def _check_login_scope(person: Person) -> str:
    if "login" not in person.scopes:
        raise Problem(403, "not-allowed", "a notebook's token cannot log in here: use the token from your course")
    return person.name


def _normalized(name: str) -> str:
    """Return the normalized name, or "" (no person's name) if it is invalid."""
    try:
        return people.normalize_name(name)
    except people.InvalidName:
        return ""


async def _confirm(request: Request, code: str, name: str, method: str, *, refused: bool) -> Response:
    if not await tokens.confirm_login(request.app.state.database, code, None if refused else name):
        raise Problem(404, "not-found", "no login request has this code: run ecp.login() again in the notebook")
    response = templates.TemplateResponse(request, "login_done.html", {"person": name, "refused": refused})
    if method:
        await sessions.start_session(request, response, name, method)
    return response


async def _page(request: Request, code: str, back: str, problem: Problem | None = None, name: str = "") -> HTMLResponse:
    person = getattr(request.state, "person", None)
    oidc, settings = request.app.state.oidc, request.app.state.settings
    label = await tokens.find_login(request.app.state.database, code) if code else None
    context = {"code": code, "label": label, "next": back, "person": person, "name": name, "error": problem and problem.detail}
    context |= {"out": "out" in request.query_params, "provider": settings.oidc_name if oidc else None}
    status, headers = (problem.status, problem.headers()) if problem else (200, {})
    response = templates.TemplateResponse(request, "login.html", context, status_code=status, headers=headers)
    sessions.store_anonymous_id(request, response)
    return response
