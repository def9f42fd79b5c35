"""The server's public address, checks of request paths and host names, and size-capped bodies."""

import ipaddress
import re
from collections.abc import Callable, Coroutine
from typing import Annotated, Any
from urllib.parse import urlsplit
from uuid import UUID

from fastapi import Depends, Request, Response
from fastapi.routing import APIRoute

from service.http.errors import Problem
from service.http.state import Config
from service.settings import Settings

LONGEST_PATH = 1000
SMALL_BODY = 16 * 1024
HOST = re.compile(r"([A-Za-z0-9._~!$&'()*+,;=%-]*|\[[0-9A-Fa-f:.]+\])(:[0-9]*)?")


async def public_address(request: Request, settings: Config) -> str:
    """Return the URL at which students reach this server, without a trailing slash."""
    return str(settings.public_url or request.base_url).rstrip("/")


PublicAddress = Annotated[str, Depends(public_address)]


def local_path(path: str) -> str:
    """Return ``path`` if it is safe to redirect to, that is a path on this server; otherwise ""."""
    inside = path.startswith("/") and not path.startswith("//") and "\\" not in path
    return path if inside and path.isascii() and path.isprintable() and " " not in path else ""


def identifier(text: str) -> UUID:
    """Return the id in a URL. Raises Problem 404 if it is not a UUID."""
    try:
        return UUID(text)
    except ValueError:
        raise Problem(404, "not-found", f"no entry with the id {text[:80]}: check the address") from None


def is_valid_host(header: str) -> bool:
    """Return whether a Host header is a host name or IP address with an optional port."""
    try:
        parts = urlsplit(f"//{header}")
        return HOST.fullmatch(header) is not None and (parts.port is None or parts.port > 0)
    except ValueError:  # not an IPv6 address, or a port above 65535
        return False


def network(address: str) -> str:
    """Return the key of an address: an IPv4 address, or the /64 network of an IPv6 address."""
    try:
        ip = ipaddress.ip_address(address)
    except ValueError:
        return "unknown"
    if isinstance(ip, ipaddress.IPv6Address):
        return str(ip.ipv4_mapped or ipaddress.ip_network((int(ip) >> 64 << 64, 64)))
    return str(ip)


def is_own_host(request: Request, settings: Settings) -> bool:
    """Return whether the Host header is an IP address, localhost or a configured name of this server.

    Rejecting other names prevents DNS rebinding.
    """
    header = request.headers.get("host", "")
    host = ("" if "@" in header else urlsplit(f"//{header}").hostname) or ""
    public_name = urlsplit(settings.public_url or "").hostname
    return host in ("localhost", settings.host, public_name) or _is_number(host)


def _is_number(host: str) -> bool:
    try:
        ipaddress.ip_address(host)
    except ValueError:
        return False
    return True


async def read_capped(request: Request, most: int, message: str) -> None:
    """Read the body into the request's cache.

    Raise Problem 413 with ``message`` if it is longer than ``most`` bytes.
    """
    body = bytearray()
    async for chunk in request.stream():
        body += chunk
        if len(body) > most:
            raise Problem(413, "too-large", message)
    request._body = bytes(body)


class SmallBody(APIRoute):
    """A route that refuses a body above SMALL_BODY bytes. FastAPI itself would read any body into memory."""

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """Return the handler of a request."""
        handle = super().get_route_handler()

        async def handle_small(request: Request) -> Response:
            await read_capped(request, SMALL_BODY, f"the body is larger than {SMALL_BODY} bytes: send less")
            return await handle(request)

        return handle_small
