"""Who may look at a page: anybody who is known, the staff of the course, or instructors only."""

from typing import Annotated
from urllib.parse import quote

from fastapi import Depends, FastAPI, Request
from fastapi.responses import RedirectResponse, Response

from service.auth.identity import STAFF, Person, authenticate, role
from service.http.errors import Problem


class LoginRequired(Exception):
    """A browser asks for a page without telling whose it is."""


async def current_user(request: Request) -> Person:
    """Whoever looks at a page, with their role in ``request.state.role``; a browser that tells nobody is sent to log in."""
    try:
        person = await authenticate(request)
    except Problem as problem:
        asks_a_program = "authorization" in request.headers or request.app.state.settings.person_header is not None
        if problem.status != 401 or asks_a_program:
            raise
        raise LoginRequired from None
    await role(request, person)
    return person


async def optional_user(request: Request) -> Person | None:
    """Whoever looks at a page that is open to all, with their role, or None if nothing tells who it is."""
    try:
        person = await authenticate(request)
    except Problem as problem:
        if problem.status != 401:
            raise
        return None
    await role(request, person)
    return person


async def staff(request: Request) -> Person:
    """An assistant or instructor; Problem 403 for anybody else."""
    person = await current_user(request)
    if request.state.role not in STAFF:
        raise Problem(403, "not-allowed", "this is for the staff of the course")
    return person


async def instructor(request: Request) -> Person:
    """An instructor; Problem 403 for anybody else."""
    person = await current_user(request)
    if request.state.role != "instructor":
        raise Problem(403, "not-allowed", "this is for instructors")
    return person


OptionalUser = Annotated[Person | None, Depends(optional_user)]
CurrentUser = Annotated[Person, Depends(current_user)]
Staff = Annotated[Person, Depends(staff)]
Instructor = Annotated[Person, Depends(instructor)]


def install(app: FastAPI) -> None:
    """Send browsers that have to log in to the page for it, and back from there."""

    async def ask(request: Request, _: Exception) -> Response:
        asked = request.url.path + (f"?{request.url.query}" if request.url.query else "")
        back = f"?next={quote(asked)}" if request.method == "GET" and asked != "/" else ""
        return RedirectResponse(f"/login{back}", 303)

    app.add_exception_handler(LoginRequired, ask)
