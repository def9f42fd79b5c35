"""Rate limit of failed logins, by name and by address. Each server process counts separately.

A browser in which the person has logged in before has its own counter, so guesses from elsewhere do not lock the person out of
it. In a new browser the person waits as the attacker does, at most one window. Tokens cannot be guessed; logins by token are not
limited.
"""

import ipaddress
import math
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager

from fastapi import Request
from limits import RateLimitItem, RateLimitItemPerMinute
from limits.storage import MemoryStorage
from limits.strategies import MovingWindowRateLimiter

from service.auth.sessions import known_browser
from service.http.errors import Problem

BY_NAME, BY_ADDRESS = RateLimitItemPerMinute(10, 15), RateLimitItemPerMinute(100, 10)
Key = tuple[RateLimitItem, str, str]


class LoginRateLimiter:
    """Counts failed and pending logins."""

    def __init__(self) -> None:
        self._failed = MovingWindowRateLimiter(MemoryStorage())
        self._pending: Counter[Key] = Counter()

    @contextmanager
    def guard(self, *keys: Key) -> Iterator[None]:
        """Guard one login, which fails by raising Problem 401.

        Raises Problem 429 if the failed and pending logins of a key reach its limit.
        """
        for key in keys:
            until, left = self._failed.get_window_stats(*key)
            if left <= self._pending[key]:
                wait_s = math.ceil(until - time.time()) if left <= 0 else 1
                raise _too_many(max(wait_s, 1))
        self._pending.update(keys)
        try:
            yield
        except Problem as problem:
            if problem.status == 401:
                for key in keys:
                    self._failed.hit(*key)
            raise
        finally:
            self._pending.subtract(keys)
            for key in keys:
                if self._pending[key] <= 0:
                    del self._pending[key]


def keys_of(request: Request, name: str) -> list[Key]:
    """Return the keys that count a login as ``name`` from this browser."""
    if (browser := known_browser(request, name)) is not None:
        return [(BY_NAME, "browser", browser)]
    return [(BY_NAME, "name", name), (BY_ADDRESS, "address", network(request.client.host if request.client else ""))]


def network(address: str) -> str:
    """Return the key of an address: an IPv4 address, or the /64 network of an IPv6 address."""
    try:
        ip = ipaddress.ip_address(address)
    except ValueError:
        return "unknown"
    if isinstance(ip, ipaddress.IPv6Address):
        return str(ip.ipv4_mapped or ipaddress.ip_network((int(ip) >> 64 << 64, 64)))
    return str(ip)


def _too_many(wait_s: int) -> Problem:
    minutes = math.ceil(wait_s / 60)
    detail = f"too many failed logins: wait {minutes} minute{'s' if minutes > 1 else ''}, or log in with the token from your course"
    return Problem(429, "too-many", detail, retry_after=wait_s)
