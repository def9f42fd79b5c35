"""Access to pages by role: logged-in people, course staff or instructors."""

from typing import Annotated
from urllib.parse import quote

from fastapi import Depends, FastAPI, Request
from fastapi.responses import RedirectResponse, Response

from service.auth.identity import STAFF, Person, authenticate, role
from service.http.errors import Problem


class LoginRequired(Exception):
    """A browser without a session requested a page; it is redirected to the log-in page."""


async def current_user(request: Request) -> Person:
    """Return the logged-in person and set ``request.state.role``.

    Raises LoginRequired for a browser without a session.
    """
    try:
        person = await authenticate(request)
    except Problem as problem:
        has_credentials = "authorization" in request.headers or request.app.state.settings.person_header is not None
        if problem.status != 401 or has_credentials:
            raise
        raise LoginRequired from None
    await role(request, person)
    return person


async def optional_user(request: Request) -> Person | None:
    """Return the logged-in person and set ``request.state.role``, or return None without a login."""
    try:
        person = await authenticate(request)
    except Problem as problem:
        if problem.status != 401:
            raise
        return None
    await role(request, person)
    return person


async def staff(request: Request) -> Person:
    """Return the person if they are an assistant or instructor; otherwise raise Problem 403."""
    person = await current_user(request)
    if request.state.role not in STAFF:
        raise Problem(403, "not-allowed", "you don't have permission: only course staff can do this")
    return person


async def instructor(request: Request) -> Person:
    """Return the person if they are an instructor; otherwise raise Problem 403."""
    person = await current_user(request)
    if request.state.role != "instructor":
        raise Problem(403, "not-allowed", "you don't have permission: only instructors can do this")
    return person


OptionalUser = Annotated[Person | None, Depends(optional_user)]
CurrentUser = Annotated[Person, Depends(current_user)]
Staff = Annotated[Person, Depends(staff)]
Instructor = Annotated[Person, Depends(instructor)]


def install(app: FastAPI) -> None:
    """Redirect browsers without a session to the log-in page, which returns them to the requested page."""

    async def redirect(request: Request, _: Exception) -> Response:
        target = request.url.path + (f"?{request.url.query}" if request.url.query else "")
        back = f"?next={quote(target)}" if request.method == "GET" and target != "/" else ""
        return RedirectResponse(f"/login{back}", 303)

    app.add_exception_handler(LoginRequired, redirect)
