"""Where students reach this server, and whether a request was made to it by such a name."""

import ipaddress
from urllib.parse import urlsplit

from fastapi import Request

from service.http.errors import Problem

LONGEST_PATH = 1000


def public_address(request: Request) -> str:
    """The address students reach this server at, without a slash at its end."""
    return str(request.app.state.settings.public_url or request.base_url).rstrip("/")


def local_path(told: str) -> str:
    """The path on this server that somebody wants to come back to; "" for anything that may lead elsewhere."""
    inside = told.startswith("/") and not told.startswith("//") and "\\" not in told
    return told if inside and told.isascii() and told.isprintable() and " " not in told else ""


def is_own_name(request: Request) -> bool:
    """Whether it was asked by number, as localhost, or by a name of its own: not by one that another site made to point here."""
    settings = request.app.state.settings
    told = request.headers.get("host", "")
    host = ("" if "@" in told else urlsplit(f"//{told}").hostname) or ""
    named = urlsplit(settings.public_url or "").hostname
    return host in ("localhost", settings.host, named) or _is_number(host)


def _is_number(host: str) -> bool:
    try:
        ipaddress.ip_address(host)
    except ValueError:
        return False
    return True


async def read_capped(request: Request, most: int, told: str) -> None:
    """Read the body into the request's own cache; Problem 413 with the sentence ``told`` for more than ``most`` of it."""
    body = bytearray()
    async for chunk in request.stream():
        body += chunk
        if len(body) > most:
            raise Problem(413, "too-large", told)
    request._body = bytes(body)
