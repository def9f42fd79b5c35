"""Who asks: by a bearer token of ours or of the hub, a browser's cookie, or a header of the proxy; else one local student."""

import contextlib
from dataclasses import dataclass

from fastapi import Request

from service.auth import sessions
from service.auth.jupyterhub import Hub
from service.http.errors import Problem
from service.http.requests import is_own_name, public_address
from service.settings import Settings
from service.store.course import people, tokens

LOCAL = "local"  # whoever asks, where nothing tells persons apart
COOKIE = sessions.COOKIE
STAFF = ("assistant", "instructor")


@dataclass(frozen=True)
class Person:
    """Who asks, and what the token given may be used for; ``alone`` where nothing tells persons apart."""

    name: str
    scopes: frozenset[str]
    alone: bool = False


async def authenticate(request: Request, scope: str = "read") -> Person:
    """The person; Problem 401 where nothing tells who it is, 403 where the token given is not for this."""
    if not hasattr(request.state, "person"):  # a page asks more than once
        request.state.person = await _identified(request)
    person: Person = request.state.person
    if scope not in person.scopes:
        raise Problem(403, "not-allowed", f"this token may {', '.join(sorted(person.scopes))}, not {scope}")
    return person


async def role(request: Request, person: Person) -> str:
    """Their role in the course, asked for once a request. Where nothing tells persons apart, everybody is instructor."""
    if not hasattr(request.state, "role"):
        request.state.role = "instructor" if person.alone else await people.role(request.app.state.database, person.name)
    told: str = request.state.role
    return told


async def by_token(request: Request, token: str) -> Person:
    """Whose token it is; Problem 401 with the reason where it is not good."""
    hub: Hub = request.app.state.hub
    if not token.startswith(tokens.PREFIX):
        if (name := await hub.user(token)) is not None:
            return Person(name, frozenset(tokens.NOTEBOOK))
        raise Problem(401, "nobody", "this is no token of this server")
    known = await tokens.find(request.app.state.database, token)
    if known is None:
        raise Problem(401, "nobody", "this server never gave that token")
    if known.over:
        raise Problem(401, "nobody", f"this token {known.over}")
    return Person(known.person, known.scopes)


def same_origin(request: Request) -> None:
    """Problem 403 unless what a browser sends came from a page of ours, or of a site that is named in the settings."""
    origin = request.headers.get("origin")
    if origin is None:
        allowed = request.headers.get("sec-fetch-site", "none") in ("same-origin", "none")
    else:
        own = {public_address(request), f"{request.url.scheme}://{request.headers.get('host', '')}"}
        allowed = origin in own or origin in request.app.state.settings.allowed_origins()
    if not allowed:
        raise Problem(403, "not-allowed", "this was not sent from a page of this server")


async def _identified(request: Request) -> Person:
    if (person := await _by_authorization(request)) is None:
        person = _by_header(request) or await _by_cookie(request) or _alone(request)
        if request.method != "GET":
            same_origin(request)  # a browser adds header and cookie to whatever a page of another site sends
    return person


async def _by_authorization(request: Request) -> Person | None:
    scheme, _, token = request.headers.get("authorization", "").partition(" ")
    token, settings = token.strip(), request.app.state.settings
    if scheme.lower() not in ("bearer", "token") or not token:
        return None
    if not token.startswith(tokens.PREFIX) and settings.identity == "local" and settings.hub_api_url is None:
        return None  # meant for somebody on the way
    return await by_token(request, token)


def _by_header(request: Request) -> Person | None:
    """Whom the proxy names; Problem 401 for what is no name."""
    header = request.app.state.settings.person_header
    told = None if header is None else request.headers.get(header)
    if not told:
        return None
    with contextlib.suppress(UnicodeDecodeError):
        told = told.encode("latin-1").decode()  # HTTP reads Latin-1, proxies send UTF-8
    try:
        return Person(people.normalize_name(told), frozenset(tokens.SCOPES))
    except people.InvalidName as error:
        raise Problem(401, "nobody", f"the header {header} names nobody: {error}") from None


async def _by_cookie(request: Request) -> Person | None:
    if (secret := sessions.read_session(request)) is None:
        return None
    known = await tokens.find(request.app.state.database, secret)
    if known is None or known.over is not None:
        return None
    request.state.session = known
    return Person(known.person, known.scopes)


def _alone(request: Request) -> Person:
    """The one local student."""
    settings: Settings = request.app.state.settings
    if settings.identity != "local" or settings.person_header is not None:
        raise Problem(401, "nobody", "the request does not tell whose it is (a notebook tells it after ecp.login())")
    if not is_own_name(request):
        raise Problem(403, "not-allowed", "this server is asked by a name it does not know: set POLHODE_PUBLIC_URL to its address")
    return Person(LOCAL, frozenset(tokens.SCOPES), alone=True)
