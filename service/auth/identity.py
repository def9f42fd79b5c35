"""Authentication of requests: bearer token of polhode or JupyterHub, proxy header, session cookie, or
single-user mode.
"""

import contextlib
from dataclasses import dataclass

from fastapi import Request

from service.auth import sessions
from service.auth.jupyterhub import Hub
from service.http.errors import Problem
from service.http.requests import is_own_host, public_address
from service.settings import Settings
from service.store.course import people, tokens

LOCAL = "local"  # the only person in single-user mode
COOKIE = sessions.COOKIE
STAFF = ("assistant", "instructor")


@dataclass(frozen=True)
class Person:
    """An authenticated person and the scopes of their token.

    ``single_user`` is true for the local student in single-user mode.
    """

    name: str
    scopes: frozenset[str]
    single_user: bool = False


async def authenticate(request: Request, scope: str = "read") -> Person:
    """Return the person that sent the request.

    Raises Problem 401 if unknown, and 403 if the token lacks ``scope``.
    """
    if not hasattr(request.state, "person"):  # cached, because several dependencies of one request need it
        request.state.person = await _identify(request)
    person: Person = request.state.person
    if scope not in person.scopes:
        raise Problem(
            403, "not-allowed", f"this token does not permit {scope}, only {', '.join(sorted(person.scopes))}: use another token"
        )
    return person


async def role(request: Request, person: Person) -> str:
    """Return the person's role in the course, cached per request.

    In single-user mode the role is instructor.
    """
    if not hasattr(request.state, "role"):
        request.state.role = "instructor" if person.single_user else await people.role(request.app.state.database, person.name)
    found: str = request.state.role
    return found


async def by_token(request: Request, token: str) -> Person:
    """Return the token's owner. Raises Problem 401 with the reason if the token is not valid."""
    hub: Hub = request.app.state.hub
    if not token.startswith(tokens.PREFIX):
        if (name := await hub.user(token)) is not None:
            return Person(name, frozenset(tokens.NOTEBOOK))
        raise Problem(401, "nobody", "this is not a token of this server: check it, or log in again to get a new one")
    info = await tokens.find(request.app.state.database, token)
    if info is None:
        raise Problem(401, "nobody", "this token is not valid here: check it, or log in again to get a new one")
    if info.over:
        raise Problem(401, "nobody", f"this token {info.over}: log in again to get a new one")
    return Person(info.person, info.scopes)


def same_origin(request: Request) -> None:
    """Raise Problem 403 if a browser sent the request from a page of another site that the settings do
    not allow.
    """
    origin = request.headers.get("origin")
    if origin is None:
        allowed = request.headers.get("sec-fetch-site", "none") in ("same-origin", "none")
    else:
        own = {public_address(request), f"{request.url.scheme}://{request.headers.get('host', '')}"}
        allowed = origin in own or origin in request.app.state.settings.allowed_origins()
    if not allowed:
        raise Problem(403, "not-allowed", "the request came from a page of another site: open this server's page and try again")


async def _identify(request: Request) -> Person:
    if (person := await _by_authorization(request)) is None:
        person = _by_header(request) or await _by_cookie(request) or _single_user(request)
        if request.method != "GET":
            same_origin(request)  # browsers add the cookie and the proxy its header to cross-site requests too
    return person


async def _by_authorization(request: Request) -> Person | None:
    scheme, _, token = request.headers.get("authorization", "").partition(" ")
    token, settings = token.strip(), request.app.state.settings
    if scheme.lower() not in ("bearer", "token") or not token:
        return None
    if not token.startswith(tokens.PREFIX) and settings.identity == "local" and settings.hub_api_url is None:
        return None  # a credential for a proxy in front of the server
    return await by_token(request, token)


def _by_header(request: Request) -> Person | None:
    """Return the person that the proxy names. Raises Problem 401 if the header is not a valid name."""
    header = request.app.state.settings.person_header
    value = None if header is None else request.headers.get(header)
    if not value:
        return None
    with contextlib.suppress(UnicodeDecodeError):
        value = value.encode("latin-1").decode()  # ASGI servers decode headers as Latin-1, proxies send UTF-8
    try:
        return Person(people.normalize_name(value), frozenset(tokens.SCOPES))
    except people.InvalidName as error:
        raise Problem(401, "nobody", f"the header {header} does not contain a valid name: {error}") from None


async def _by_cookie(request: Request) -> Person | None:
    if (secret := sessions.read_session(request)) is None:
        return None
    info = await tokens.find(request.app.state.database, secret)
    if info is None or info.over is not None:
        return None
    request.state.session = info
    return Person(info.person, info.scopes)


def _single_user(request: Request) -> Person:
    settings: Settings = request.app.state.settings
    if settings.identity != "local" or settings.person_header is not None:
        raise Problem(401, "nobody", "authentication required: run ecp.login() in the notebook, or log in on the web page")
    if not is_own_host(request):
        raise Problem(403, "not-allowed", "the request used an unknown host name: set POLHODE_PUBLIC_URL to the server's address")
    return Person(LOCAL, frozenset(tokens.SCOPES), single_user=True)
