"""Browser cookies: the signed session, the person the browser is known for, and the anonymous visit
before a login.
"""

import hashlib
import re
import secrets
from typing import Any

from fastapi import Request, Response
from itsdangerous import BadData, TimestampSigner, URLSafeTimedSerializer

from service.http.requests import public_address
from service.store.course import audit, tokens

COOKIE = "polhode_session"  # the session's secret, signed
KNOWN = "polhode_known"  # the person that last logged in with this browser
VISIT = "polhode_visit"  # binds CSRF tokens before a login
SESSION_S = 12 * 3600
KNOWN_S = 180 * 24 * 3600


def read_session(request: Request) -> str | None:
    """Return the secret of the browser's session, or None without a valid cookie.

    The session itself, which the database holds, expires after twelve hours. The cookie's time is not
    checked, as a cookie from the future, signed before the clock went back, would be refused.
    """
    try:
        return _signer(request).unsign(request.cookies.get(COOKIE, "")).decode()
    except (BadData, UnicodeDecodeError):
        return None


async def start_session(request: Request, response: Response, name: str, method: str) -> None:
    """Start a session for the person, replacing the browser's previous session.

    ``method`` is how they logged in.
    """
    database, previous = request.app.state.database, read_session(request)
    info = None if previous is None else await tokens.find(database, previous)
    async with database.begin() as connection:
        if info is not None:
            await tokens.revoke(connection, id=info.id)
        label = f"{_browser(request)}, by {method}"
        secret = await tokens.create_session(connection, name, label=label, seconds=SESSION_S)
        if method == "password":
            await audit.record(connection, name, "log in", name, {"by": method})
    set_cookie(request, response, COOKIE, _signer(request).sign(secret).decode(), max_age=SESSION_S)
    set_cookie(request, response, KNOWN, serializer(request, "known").dumps([name, secrets.token_hex(8)]), max_age=KNOWN_S)
    response.delete_cookie(VISIT)


def clear_session(response: Response) -> Response:
    """Delete the session cookie with this response and return it."""
    response.delete_cookie(COOKIE)
    return response


def known_browser(request: Request, name: str) -> str | None:
    """Return the browser's identifier if the person has logged in with it before, otherwise None."""
    try:
        owner, id = serializer(request, "known").loads(request.cookies.get(KNOWN, ""), max_age=KNOWN_S)
    except BadData:
        return None
    return str(id) if owner == name else None


def anonymous_id(request: Request) -> str:
    """Return the secret that identifies a browser before a login; ``store_anonymous_id`` saves a new
    one as a cookie.
    """
    cookie = request.cookies.get(VISIT, "")
    if re.fullmatch(r"[\w-]{43}", cookie, re.ASCII):
        return cookie
    if not hasattr(request.state, "visit"):
        request.state.visit = secrets.token_urlsafe(32)
    return str(request.state.visit)


def store_anonymous_id(request: Request, response: Response) -> None:
    """Set the cookie of the anonymous id if it is new."""
    if hasattr(request.state, "visit"):
        set_cookie(request, response, VISIT, request.state.visit)


def set_cookie(request: Request, response: Response, name: str, value: str, **options: Any) -> None:
    """Set a cookie that scripts cannot read and that forms of other sites do not send."""
    secure = public_address(request).startswith("https://")
    response.set_cookie(name, value, httponly=True, samesite="lax", secure=secure, **options)


def serializer(request: Request, purpose: str) -> URLSafeTimedSerializer:
    """Return a serializer that signs with a key derived for ``purpose``, the same on all servers."""
    return URLSafeTimedSerializer(request.app.state.secret, salt=f"polhode {purpose}", signer_kwargs=_SHA256)


def _signer(request: Request) -> TimestampSigner:
    return TimestampSigner(request.app.state.secret, salt="polhode session", **_SHA256)


def _browser(request: Request) -> str:
    """Return the browser and system of the User-Agent header as text, so that the person recognises the
    session.
    """
    agent = request.headers.get("user-agent", "")
    name = next((name for mark, name in _BROWSERS if mark in agent), "a browser")
    system = next((name for mark, name in _SYSTEMS if mark in agent), None)
    return f"{name} on {system}" if system else name


_SHA256: dict[str, Any] = {"digest_method": hashlib.sha256, "key_derivation": "hmac"}
_BROWSERS = (("Edg", "Edge"), ("OPR/", "Opera"), ("Firefox/", "Firefox"), ("Chrome/", "Chrome"), ("Safari/", "Safari"))
_SYSTEMS = (
    ("Android", "Android"),
    ("iPhone", "iPhone"),
    ("iPad", "iPad"),
    ("Windows", "Windows"),
    ("Mac OS X", "macOS"),
    ("Linux", "Linux"),
)
