"""Browser cookies: the signed session, the person the browser is known for, the anonymous visit before a
login, and as whom the staff sees the pages.
"""

import hashlib
import re
import secrets
from datetime import UTC, datetime, timedelta
from functools import cached_property
from typing import Annotated, Any

from fastapi import Depends, Request, Response
from itsdangerous import BadData, TimestampSigner, URLSafeTimedSerializer

from service.http.requests import PublicAddress
from service.http.state import Db, Held
from service.store.course import audit
from service.store.database import Database
from service.store.people import tokens

COOKIE = "polhode_session"  # the session's secret, signed
KNOWN = "polhode_known"  # the person that last logged in with this browser
VISIT = "polhode_visit"  # binds CSRF tokens before a login
VIEW = "polhode_view"  # as which student a member of the staff sees the pages
SESSION_S = 12 * 3600
KNOWN_S = 180 * 24 * 3600


class Secret(bytes):
    """The key that signs cookies and forms, the same on all servers."""


class Cookies:
    """The cookies of the browser that sent ``request``. With ``secure``, it returns them over https only."""

    def __init__(self, request: Request, secret: bytes, database: Database, *, secure: bool) -> None:
        self._request, self.secret, self._database, self._secure = request, secret, database, secure
        self._signer = TimestampSigner(secret, salt="polhode session", **_SHA256)

    def session(self) -> str | None:
        """Return the secret of the browser's session, or None without a valid cookie.

        The session itself, which the database holds, expires after twelve hours. The cookie's time is not
        checked, as a cookie from the future, signed before the clock went back, would be refused.
        """
        try:
            return self._signer.unsign(self._request.cookies.get(COOKIE, "")).decode()
        except (BadData, UnicodeDecodeError):
            return None

    async def start_session(self, response: Response, name: str, method: str) -> None:
        """Start a session for the person, replacing the browser's previous session.

        ``method`` is how they logged in.
        """
        previous = self.session()
        info = None if previous is None else await tokens.find(self._database, previous)
        async with self._database.begin() as connection:
            if info is not None:
                await tokens.revoke(connection, id=info.id)
            label = f"{_browser(self._request)}, by {method}"
            secret = await tokens.create_session(connection, name, label=label, seconds=SESSION_S)
            if method == "password":
                await audit.record(connection, name, "log in", name, {"by": method})
        self.set(response, COOKIE, self._signer.sign(secret).decode(), max_age=SESSION_S)
        self.set(
            response, KNOWN, self.serializer("known").dumps([name, secrets.token_hex(8)]), max_age=KNOWN_S
        )
        response.delete_cookie(VISIT)
        self.stop_viewing(response)

    def known_browser(self, name: str) -> str | None:
        """Return the browser's identifier if the person has logged in with it before, otherwise None.

        A cookie from the future, signed before the clock went back, is good.
        """
        cookie = self._request.cookies.get(KNOWN, "")
        try:
            (owner, id), signed_at = self.serializer("known").loads(cookie, return_timestamp=True)
        except BadData:
            return None
        fresh = datetime.now(UTC) - signed_at < timedelta(seconds=KNOWN_S)
        return str(id) if owner == name and fresh else None

    @cached_property
    def anonymous_id(self) -> str:
        """The secret that identifies a browser before a login; ``store_anonymous_id`` saves a new one as a
        cookie.
        """
        cookie = self._request.cookies.get(VISIT, "")
        return cookie if re.fullmatch(r"[\w-]{43}", cookie, re.ASCII) else secrets.token_urlsafe(32)

    def store_anonymous_id(self, response: Response) -> None:
        """Set the cookie of the anonymous id if it is used and new."""
        if self.__dict__.get("anonymous_id", cookie := self._request.cookies.get(VISIT)) != cookie:
            self.set(response, VISIT, self.anonymous_id)

    def view_as(self, response: Response, owner: str, name: str) -> None:
        """Let ``owner`` see the pages as ``name`` does, for as long as a session lasts."""
        value = str(self.serializer("view").dumps([owner, name]))
        self.set(response, VIEW, value, max_age=SESSION_S)

    def viewed_as(self, owner: str) -> str | None:
        """Return as whom ``owner`` sees the pages, None if as themselves."""
        try:
            viewer, name = self.serializer("view").loads(self._request.cookies.get(VIEW, ""))
        except BadData:
            return None
        return str(name) if viewer == owner else None

    def stop_viewing(self, response: Response) -> None:
        """Let the browser's person see the pages as themselves."""
        response.delete_cookie(VIEW)

    def set(self, response: Response, name: str, value: str, **options: Any) -> None:
        """Set a cookie that scripts cannot read and that forms of other sites do not send."""
        response.set_cookie(name, value, httponly=True, samesite="lax", secure=self._secure, **options)

    def serializer(self, purpose: str) -> URLSafeTimedSerializer:
        """Return a serializer that signs with a key derived for ``purpose``, the same on all servers."""
        return URLSafeTimedSerializer(self.secret, salt=f"polhode {purpose}", signer_kwargs=_SHA256)


async def cookies(request: Request, secret: Held[Secret], database: Db, address: PublicAddress) -> Cookies:
    """Return the cookies of the request's browser."""
    return Cookies(request, secret, database, secure=address.startswith("https://"))


BrowserCookies = Annotated[Cookies, Depends(cookies)]


def clear_session(response: Response) -> Response:
    """Delete the session cookie with this response and return it."""
    response.delete_cookie(COOKIE)
    return response


def _browser(request: Request) -> str:
    """Return the browser and system of the User-Agent header as text, so that the person recognises the
    session.
    """
    agent = request.headers.get("user-agent", "")
    name = next((name for mark, name in _BROWSERS if mark in agent), "a browser")
    system = next((name for mark, name in _SYSTEMS if mark in agent), None)
    return f"{name} on {system}" if system else name


_SHA256: dict[str, Any] = {"digest_method": hashlib.sha256, "key_derivation": "hmac"}
_BROWSERS = (
    ("Edg", "Edge"),
    ("OPR/", "Opera"),
    ("Firefox/", "Firefox"),
    ("Chrome/", "Chrome"),
    ("Safari/", "Safari"),
)
_SYSTEMS = (
    ("Android", "Android"),
    ("iPhone", "iPhone"),
    ("iPad", "iPad"),
    ("Windows", "Windows"),
    ("Mac OS X", "macOS"),
    ("Linux", "Linux"),
)
