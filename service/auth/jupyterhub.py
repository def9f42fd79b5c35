"""JupyterHub tokens, verified at the hub, so that a kernel submits with the token that the hub gave it."""

import asyncio
import json
import time
import urllib.error
import urllib.request
from concurrent.futures import ThreadPoolExecutor
from hashlib import sha256
from http.client import HTTPException
from typing import Any

from service.http.errors import Problem
from service.store.people import people

CACHED_S, REFUSED_S, TIMEOUT_S, MOST_CACHED, LONGEST_TOKEN = 60.0, 5.0, 5.0, 10_000, 300


class Hub:
    """Client of the hub API at ``api_url`` (None: no hub), where polhode is registered as ``service``."""

    def __init__(self, api_url: str | None, service: str) -> None:
        self._url = None if api_url is None else api_url.rstrip("/") + "/user"
        self._needed = {"access:services", f"access:services!service={service}"}
        self._cache: dict[str, tuple[float, str | None]] = {}
        # a separate pool, so that a slow hub delays nothing else
        self._threads = ThreadPoolExecutor(4, "hub")

    async def user(self, token: str) -> str | None:
        """Return the name of the token's user, or None if the token is not valid for polhode.

        Raises Problem 503 if the hub does not respond. A token must have the scope to access this service;
        otherwise any token that leaked from another service would be accepted.
        """
        if self._url is None or len(token) > LONGEST_TOKEN or not (token.isascii() and token.isprintable()):
            return None
        key, now = sha256(token.encode()).hexdigest(), time.monotonic()
        until, name = self._cache.get(key, (0.0, None))
        if now >= until:
            name = await asyncio.get_running_loop().run_in_executor(self._threads, self._request_user, token)
            if len(self._cache) >= MOST_CACHED:
                self._cache = {
                    k: entry for k, entry in self._cache.items() if entry[1] is not None and entry[0] > now
                }
            self._cache[key] = (now + (REFUSED_S if name is None else CACHED_S), name)
        return name

    def stop(self) -> None:
        """Cancel pending requests to the hub."""
        self._threads.shutdown(wait=False, cancel_futures=True)

    def _request_user(self, token: str) -> str | None:
        assert self._url is not None
        try:
            request = urllib.request.Request(self._url, headers={"Authorization": f"token {token}"})  # noqa: S310
            with _opener.open(request, timeout=TIMEOUT_S) as response:
                user = json.loads(response.read(1 << 20))
            name, kind, scopes = user["name"], user["kind"], set(user["scopes"])
            return people.normalize_name(name) if kind == "user" and self._needed & scopes else None
        except urllib.error.HTTPError as error:
            with error:
                if error.code in (401, 403):
                    return None
                raise Problem(
                    503, "busy", f"JupyterHub returned status {error.code}: try again in a moment"
                ) from None
        except (OSError, ValueError, LookupError, TypeError, AttributeError, HTTPException) as error:
            raise Problem(
                503, "busy", f"JupyterHub does not respond: try again in a moment ({type(error).__name__})"
            ) from None


class _NoRedirect(urllib.request.HTTPRedirectHandler):
    # A redirect must not carry the token to another address.

    def redirect_request(self, *args: Any) -> None:
        return None


_opener = urllib.request.build_opener(_NoRedirect)
