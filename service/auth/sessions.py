"""Cookies of a browser: its session, signed so that a forged one costs nothing; who it is known for; a visit before any login."""

import hashlib
import re
import secrets
from typing import Any

from fastapi import Request, Response
from itsdangerous import BadData, TimestampSigner, URLSafeTimedSerializer

from service.http.requests import public_address
from service.store.course import people, tokens

COOKIE = "polhode_session"  # the session's secret, signed
KNOWN = "polhode_known"  # for whom somebody has logged in here before
VISIT = "polhode_visit"  # what the tokens of forms are bound to until then
SESSION_S = 12 * 3600
KNOWN_S = 180 * 24 * 3600


def read_session(request: Request) -> str | None:
    """The secret of the browser's session; None without a cookie that was signed here in the last twelve hours."""
    try:
        return _signer(request).unsign(request.cookies.get(COOKIE, ""), max_age=SESSION_S).decode()
    except (BadData, UnicodeDecodeError):
        return None


async def start_session(request: Request, response: Response, name: str, how: str) -> None:
    """A new session for that person, who has logged in, in the place of whichever the browser had."""
    database, before = request.app.state.database, read_session(request)
    known = None if before is None else await tokens.find(database, before)
    async with database.begin() as connection:
        if known is not None:
            await tokens.revoke(connection, id=known.id)
        label = f"{_browser(request)}, by {how}"
        secret = await tokens.create_session(connection, name, label=label, seconds=SESSION_S)
        if how == "password":
            await people.record_audit(connection, name, "log in", name, {"by": how})
    set_cookie(request, response, COOKIE, _signer(request).sign(secret).decode(), max_age=SESSION_S)
    set_cookie(request, response, KNOWN, serializer(request, "known").dumps([name, secrets.token_hex(8)]), max_age=KNOWN_S)
    response.delete_cookie(VISIT)


def clear_session(response: Response) -> Response:
    """That response, with which the browser forgets its session."""
    response.delete_cookie(COOKIE)
    return response


def known_as(request: Request, name: str) -> str | None:
    """What tells this browser from others if that person has logged in with it before; None if not."""
    try:
        whose, id = serializer(request, "known").loads(request.cookies.get(KNOWN, ""), max_age=KNOWN_S)
    except BadData:
        return None
    return str(id) if whose == name else None


def anonymous_id(request: Request) -> str:
    """A secret of a browser that nobody has logged in with; ``keep_visit`` puts a new one into its cookies."""
    given = request.cookies.get(VISIT, "")
    if re.fullmatch(r"[\w-]{43}", given, re.ASCII):
        return given
    if not hasattr(request.state, "visit"):
        request.state.visit = secrets.token_urlsafe(32)
    return str(request.state.visit)


def store_anonymous_id(request: Request, response: Response) -> None:
    """Give the browser the visit that forms were bound to, if it is new."""
    if hasattr(request.state, "visit"):
        set_cookie(request, response, VISIT, request.state.visit)


def set_cookie(request: Request, response: Response, name: str, value: str, **terms: Any) -> None:
    """Set a cookie that no script reads and that no form of another site brings along."""
    secure = public_address(request).startswith("https://")
    response.set_cookie(name, value, httponly=True, samesite="lax", secure=secure, **terms)


def serializer(request: Request, what: str) -> URLSafeTimedSerializer:
    """To sign with a key that is used for ``what`` and nothing else; the same on all servers."""
    return URLSafeTimedSerializer(request.app.state.secret, salt=f"polhode {what}", signer_kwargs=_SHA256)


def _signer(request: Request) -> TimestampSigner:
    return TimestampSigner(request.app.state.secret, salt="polhode session", **_SHA256)


def _browser(request: Request) -> str:
    """Which browser it says it is, for the person to recognise it by."""
    told = request.headers.get("user-agent", "")
    name = next((name for mark, name in _BROWSERS if mark in told), "a browser")
    system = next((name for mark, name in _SYSTEMS if mark in told), None)
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
