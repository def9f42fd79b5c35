"""Log-in and log-out pages, and the authorization of a notebook by its code."""

from contextlib import suppress
from typing import Annotated

from fastapi import APIRouter, Request, Response
from fastapi.responses import HTMLResponse, RedirectResponse
from pydantic import AfterValidator

from service.auth import cookies
from service.auth.cookies import BrowserCookies
from service.auth.forms import PublicForm, SameOrigin, field, raw_field
from service.auth.identity import Person, Visitor, by_token
from service.auth.jupyterhub import Hub
from service.auth.passwords import PasswordChecker
from service.auth.rate_limit import LoginRateLimiter, keys_of, keys_of_code
from service.auth.roles import OptionalUser
from service.http.errors import Problem, wants_page
from service.http.requests import LONGEST_PATH, local_path
from service.http.state import Config, Db, Held
from service.http.templating import templates
from service.pages.rejected_forms import post_form
from service.store.people import people, tokens

router = APIRouter()
Code = Annotated[str, AfterValidator(lambda code: code[:20])]
Next = Annotated[str, AfterValidator(lambda path: local_path(path[:LONGEST_PATH]))]


class UnknownCode(Problem):
    """No notebook waits for a login with that code."""

    def __init__(self) -> None:
        super().__init__(
            404, "not-found", "no login request has this code: run polhode.login() again in the notebook"
        )


@router.get("/login", response_class=HTMLResponse)
async def login_page(
    request: Request,
    person: OptionalUser,
    settings: Config,
    database: Db,
    cookies: BrowserCookies,
    limits: Held[LoginRateLimiter],
    code: Code = "",
    next: Next = "",
) -> Response:
    """Show the log-in page, or the authorization page for a notebook's code."""
    label = None
    if code:
        name = person.name if person else None
        with suppress(UnknownCode), limits.guard(*keys_of_code(request, name), failure=404):
            if (label := await tokens.find_login(database, code)) is None:
                raise UnknownCode
    context = {
        "code": code,
        "label": label,
        "next": next,
        "person": person,
        "out": "out" in request.query_params,
        "provider": settings.oidc_issuer and settings.oidc_name,
    }
    response = templates.TemplateResponse(request, "login.html", context)
    cookies.store_anonymous_id(response)
    return response


@post_form(router, "/login", page=login_page, at="/login")
async def login(
    request: Request,
    form: PublicForm,
    visitor: Visitor,
    database: Db,
    cookies: BrowserCookies,
    hub: Held[Hub],
    checker: Held[PasswordChecker],
    limits: Held[LoginRateLimiter],
    code: Code = "",
    next: Next = "",
) -> Response:
    """Log in by password or token and redirect to the requested page, or authorize or refuse a
    notebook's code.
    """
    token, password, name = (
        field(form, "token"),
        raw_field(form, "password"),
        _normalized(field(form, "name")),
    )
    method = "token" if token else "password" if name or password else ""  # "" is an existing session
    if token:
        name = _check_login_scope(await by_token(token, database, hub))
    elif method:
        with limits.guard(*keys_of(request, cookies, name)):
            await checker.check(name, password)
    elif isinstance(visitor, Problem):
        if not wants_page(request):
            raise visitor
        raise Problem(401, "nobody", "enter your name and password, or a token from your course")
    else:
        name = visitor.with_scope("login").name
    refused = bool(field(form, "refuse"))
    if code:
        with limits.guard(*keys_of_code(request, name), failure=404):
            if not await tokens.confirm_login(database, code, None if refused else name):
                raise UnknownCode
    response: Response = RedirectResponse(next or "/", 303)
    if code:
        response = templates.TemplateResponse(
            request, "login_done.html", {"person": name, "refused": refused}
        )
    if method:
        await cookies.start_session(response, name, method)
    return response


@router.post("/logout")
async def logout(origin: SameOrigin, person: OptionalUser, database: Db) -> Response:
    """End the browser's session on all servers.

    The form is in every page and has no token, as compressed pages must not contain one: the origin is
    checked, and browsers send the session's cookie only with forms of this site.
    """
    if person is not None and person.session:
        async with database.begin() as connection:
            await tokens.revoke(connection, id=person.session)
    return cookies.clear_session(RedirectResponse("/login?out=1", 303))


def _check_login_scope(person: Person) -> str:
    if "login" not in person.scopes:
        raise Problem(
            403, "not-allowed", "a notebook's token cannot log in here: use the token from your course"
        )
    return person.name


def _normalized(name: str) -> str:
    """Return the normalized name, or "" (no person's name) if it is invalid."""
    try:
        return people.normalize_name(name)
    except people.InvalidName:
        return ""
