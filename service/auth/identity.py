"""Authentication of requests: bearer token of polhode or JupyterHub, proxy header, session cookie, or
single-user mode.
"""

import contextlib
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Annotated, Any
from uuid import UUID

from fastapi import Depends, Request
from fastapi.security import HTTPBearer

from service.auth import cookies
from service.auth.cookies import BrowserCookies
from service.auth.jupyterhub import Hub
from service.http.errors import Problem
from service.http.requests import PublicAddress, is_own_host
from service.http.state import Config, Db, Held
from service.settings import Settings
from service.store.database import Database
from service.store.people import first_instructor, people, tokens

LOCAL = "local"  # the only person in single-user mode
COOKIE = cookies.COOKIE
STAFF = people.STAFF
# The OpenAPI document declares it. ``identify`` reads the header itself, because JupyterHub sends the scheme
# "token" too.
Bearer = Annotated[
    object, Depends(HTTPBearer(auto_error=False, description="A token of polhode, or of JupyterHub."))
]


@dataclass(frozen=True)
class Person:
    """An authenticated person, the scopes of their token, and their role in the course.

    ``single_user`` is true for the local student in single-user mode, whose role is instructor. ``session``
    is the id of the browser's session. ``viewer`` is the member of the staff who sees the pages as this
    student does, "" if nobody.
    """

    name: str
    scopes: frozenset[str]
    role: str = "student"
    single_user: bool = False
    session: UUID | None = None
    viewer: str = ""

    @property
    def views_another(self) -> bool:
        """Whether a member of the staff sees the pages as another person does, and can only read."""
        return self.viewer not in ("", self.name)

    def with_scope(self, scope: str) -> "Person":
        """Return the person. Raises Problem 403 if the token lacks ``scope``."""
        if scope not in self.scopes and self.views_another:
            detail = (
                f"you see the pages as {self.name} does and can change nothing: press Stop, then try again"
            )
            raise Problem(403, "not-allowed", detail)
        if scope not in self.scopes:
            raise Problem(
                403,
                "not-allowed",
                f"this token does not permit {scope}, only {', '.join(sorted(self.scopes))}: use another"
                " token",
            )
        return self


async def identify(
    request: Request,
    settings: Config,
    database: Db,
    hub: Held[Hub],
    cookies: BrowserCookies,
    address: PublicAddress,
    bearer: Bearer,
) -> Person | Problem:
    """Return the person that sent the request, or the Problem 401 to raise if the route needs a person.

    Templates find the person and the cookies in ``request.state``.
    """
    request.state.person, request.state.cookies = None, cookies
    try:
        if (person := await _by_authorization(request, settings, database, hub)) is None:
            person = await _by_header(request, settings, database) or await _by_cookie(cookies, database)
            person = person or await _single_user(request, settings, database)
            person = await _as_student(person, cookies, database)
            if request.method != "GET":
                # browsers add cookie and proxy header to cross-site requests too
                await same_origin(request, settings, address)
    except Problem as problem:
        if problem.status != 401:
            raise
        return problem
    request.state.person = person
    return person


Visitor = Annotated[Person | Problem, Depends(identify)]


def permitted(scope: str) -> Any:
    """Return the dependency on a person whose token has ``scope``.

    It raises Problem 401 without one, and 403, also for who has left the course and would submit.
    """

    async def authenticate(visitor: Visitor) -> Person:
        if isinstance(visitor, Problem):
            raise visitor
        if scope == "submit" and visitor.role == "former":
            raise Problem(
                403, "not-allowed", "you have left this course and can only read: ask the course staff"
            )
        return visitor.with_scope(scope)

    return Depends(authenticate)


Reader = Annotated[Person, permitted("read")]
Submitter = Annotated[Person, permitted("submit")]


async def by_token(token: str, database: Database, hub: Hub) -> Person:
    """Return the token's owner. Raises Problem 401 with the reason if the token is not valid."""
    if not token.startswith(tokens.PREFIX):
        if (name := await hub.user(token)) is not None:
            return await _person(database, name, tokens.NOTEBOOK)
        raise Problem(
            401, "nobody", "this is not a token of this server: check it, or log in again to get a new one"
        )
    info = await tokens.find(database, token)
    if info is None:
        raise Problem(
            401, "nobody", "this token is not valid here: check it, or log in again to get a new one"
        )
    if info.over:
        raise Problem(401, "nobody", f"this token {info.over}: log in again to get a new one")
    return Person(info.person, info.scopes, info.role)


async def same_origin(request: Request, settings: Config, address: PublicAddress) -> None:
    """Raise Problem 403 if a browser sent the request from a page of another site that the settings do
    not allow.
    """
    origin = request.headers.get("origin")
    if origin is None:
        allowed = request.headers.get("sec-fetch-site", "none") in ("same-origin", "none")
    else:
        own = {address, f"{request.url.scheme}://{request.headers.get('host', '')}"}
        allowed = origin in own or origin in settings.allowed_origins()
    if not allowed:
        raise Problem(
            403,
            "not-allowed",
            "the request came from a page of another site: open this server's page and try again",
        )


async def _by_authorization(
    request: Request, settings: Settings, database: Database, hub: Hub
) -> Person | None:
    scheme, _, token = request.headers.get("authorization", "").partition(" ")
    token = token.strip()
    if scheme.lower() not in ("bearer", "token") or not token:
        return None
    if not token.startswith(tokens.PREFIX) and settings.identity == "local" and settings.hub_api_url is None:
        return None  # a credential for a proxy in front of the server
    return await by_token(token, database, hub)


async def _by_header(request: Request, settings: Settings, database: Database) -> Person | None:
    """Return the person that the proxy names. Raises Problem 401 if the header is not a valid name."""
    header = settings.person_header
    value = None if header is None else request.headers.get(header)
    if not value:
        return None
    with contextlib.suppress(UnicodeDecodeError):
        value = value.encode("latin-1").decode()  # ASGI servers decode headers as Latin-1, proxies send UTF-8
    try:
        return await _person(database, people.normalize_name(value), tokens.SCOPES)
    except people.InvalidName as error:
        raise Problem(401, "nobody", f"the header {header} does not contain a valid name: {error}") from None


async def _by_cookie(cookies: cookies.Cookies, database: Database) -> Person | None:
    if (secret := cookies.session()) is None:
        return None
    info = await tokens.find(database, secret)
    if info is None or info.over is not None:
        return None
    scopes = info.scopes | {"submit"}  # by the form on an assignment's page
    return Person(info.person, scopes, info.role, session=info.id)


async def _single_user(request: Request, settings: Settings, database: Database) -> Person:
    if not settings.is_single_user or await first_instructor.people_log_in(database):
        raise Problem(
            401,
            "nobody",
            "authentication required: run polhode.login() in the notebook, or log in on the web page",
        )
    if not is_own_host(request, settings):
        raise Problem(
            403,
            "not-allowed",
            "the request used an unknown host name: set POLHODE_PUBLIC_URL to the server's address",
        )
    return Person(LOCAL, frozenset(tokens.SCOPES), "instructor", single_user=True)


async def _as_student(person: Person, cookies: cookies.Cookies, database: Database) -> Person:
    """Return the student as whom a member of the staff has chosen to see the pages, else ``person``."""
    name = cookies.viewed_as(person.name) if person.role in STAFF else None
    if name is None:
        return person
    if name == person.name:
        return replace(person, role="student", viewer=name)
    role = await people.role(database, name)
    if role in STAFF:  # meanwhile
        return person
    return Person(name, frozenset({"read"}), role, session=person.session, viewer=person.name)


async def _person(database: Database, name: str, scopes: Iterable[str]) -> Person:
    return Person(name, frozenset(scopes), await people.role(database, name))
