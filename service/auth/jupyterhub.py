"""Tokens of a JupyterHub, verified at the hub: a kernel there submits with the token it has anyway."""

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
from service.store.course import people

KEPT_S, REFUSED_S, ANSWER_S, MOST_KEPT, LONGEST_TOKEN = 60.0, 5.0, 5.0, 10_000, 300


class Hub:
    """The hub whose interface is at ``api_url`` (None: there is no hub), as which our service goes by the name ``service``."""

    def __init__(self, api_url: str | None, service: str) -> None:
        self._url = None if api_url is None else api_url.rstrip("/") + "/user"
        self._needed = {"access:services", f"access:services!service={service}"}
        self._kept: dict[str, tuple[float, str | None]] = {}
        self._threads = ThreadPoolExecutor(4, "hub")  # of its own: a hub that is slow holds up nothing else

    async def user(self, token: str) -> str | None:
        """The name of the token's user; None where it is not for us. Problem 503 while the hub does not answer.

        A token must be meant for us, by its scope to access our service: others would let anybody who got hold of one act here.
        """
        if self._url is None or len(token) > LONGEST_TOKEN or not (token.isascii() and token.isprintable()):
            return None
        key, now = sha256(token.encode()).hexdigest(), time.monotonic()
        until, name = self._kept.get(key, (0.0, None))
        if now >= until:
            name = await asyncio.get_running_loop().run_in_executor(self._threads, self._ask, token)
            if len(self._kept) >= MOST_KEPT:
                self._kept = {k: kept for k, kept in self._kept.items() if kept[1] is not None and kept[0] > now}
            self._kept[key] = (now + (REFUSED_S if name is None else KEPT_S), name)
        return name

    def stop(self) -> None:
        """Ask no more."""
        self._threads.shutdown(wait=False, cancel_futures=True)

    def _ask(self, token: str) -> str | None:
        assert self._url is not None
        try:
            request = urllib.request.Request(self._url, headers={"Authorization": f"token {token}"})  # noqa: S310
            with _opener.open(request, timeout=ANSWER_S) as answer:
                told = json.loads(answer.read(1 << 20))
            name, kind, scopes = told["name"], told["kind"], set(told["scopes"])
            return people.normalize_name(name) if kind == "user" and self._needed & scopes else None
        except urllib.error.HTTPError as error:
            with error:
                if error.code in (401, 403):
                    return None
                raise Problem(503, "busy", f"the hub answers {error.code}: try again in a moment") from None
        except (OSError, ValueError, LookupError, TypeError, AttributeError, HTTPException) as error:
            raise Problem(503, "busy", f"the hub does not answer: try again in a moment ({type(error).__name__})") from None


class _Stay(urllib.request.HTTPRedirectHandler):
    """A token goes to the address that was set and to no other."""

    def redirect_request(self, *args: Any) -> None:
        return None


_opener = urllib.request.build_opener(_Stay)
