"""Access to pages by role: logged-in people, course staff or instructors."""

from typing import Annotated
from urllib.parse import quote

from fastapi import Depends, FastAPI, Request
from fastapi.responses import RedirectResponse, Response

from service.auth.identity import STAFF, Person, Visitor
from service.http.errors import Problem
from service.http.state import Config


class LoginRequired(Exception):
    """A browser without a session requested a page; it is redirected to the log-in page."""


async def current_user(request: Request, settings: Config, visitor: Visitor) -> Person:
    """Return the logged-in person. Raises LoginRequired for a browser without a session."""
    if isinstance(visitor, Person):
        return visitor.with_scope("read")
    if "authorization" in request.headers or settings.person_header is not None:
        raise visitor
    raise LoginRequired


async def optional_user(visitor: Visitor) -> Person | None:
    """Return the logged-in person, or None without a login."""
    return visitor.with_scope("read") if isinstance(visitor, Person) else None


CurrentUser = Annotated[Person, Depends(current_user)]
OptionalUser = Annotated[Person | None, Depends(optional_user)]


async def staff(person: CurrentUser) -> Person:
    """Return the person if they are an assistant or instructor; otherwise raise Problem 403."""
    if person.role not in STAFF:
        raise Problem(403, "not-allowed", "you don't have permission: only course staff can do this")
    return person


async def instructor(person: CurrentUser) -> Person:
    """Return the person if they are an instructor; otherwise raise Problem 403."""
    if person.role != "instructor":
        raise Problem(403, "not-allowed", "you don't have permission: only instructors can do this")
    return person


Staff = Annotated[Person, Depends(staff)]
Instructor = Annotated[Person, Depends(instructor)]


def install(app: FastAPI) -> None:
    """Redirect browsers without a session to the log-in page, which returns them to the requested page."""

    async def redirect(request: Request, _: Exception) -> Response:
        target = request.url.path + (f"?{request.url.query}" if request.url.query else "")
        back = f"?next={quote(target)}" if request.method == "GET" and target != "/" else ""
        return RedirectResponse(f"/login{back}", 303)

    app.add_exception_handler(LoginRequired, redirect)
