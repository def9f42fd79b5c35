"""Failed logins are counted, by name and by address, and who has failed too often has to wait. Each server counts for itself.

A browser that the person has logged in with before is counted apart: so whoever guesses at a name, or from behind the same
address, does not keep the person out of it. Elsewhere they wait as the guesser does, at most a window, and a token still
logs them in, as tokens cannot be guessed and are not counted.
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

from service.auth.sessions import known_as
from service.http.errors import Problem

BY_NAME, BY_ADDRESS = RateLimitItemPerMinute(10, 15), RateLimitItemPerMinute(100, 10)
Key = tuple[RateLimitItem, str, str]


class LoginRateLimiter:
    """What has failed in the last minutes, and what is being tried."""

    def __init__(self) -> None:
        self._failed = MovingWindowRateLimiter(MemoryStorage())
        self._tried: Counter[Key] = Counter()

    @contextmanager
    def attempt(self, *keys: Key) -> Iterator[None]:
        """Around a try, which fails by a Problem with status 401; Problem 429 where too many have failed, or may yet."""
        for key in keys:
            until, left = self._failed.get_window_stats(*key)
            if left <= self._tried[key]:
                wait_s = math.ceil(until - time.time()) if left <= 0 else 1
                raise _too_many(max(wait_s, 1))
        self._tried.update(keys)
        try:
            yield
        except Problem as problem:
            if problem.status == 401:
                for key in keys:
                    self._failed.hit(*key)
            raise
        finally:
            self._tried.subtract(keys)
            for key in keys:
                if self._tried[key] <= 0:
                    del self._tried[key]


def keys_of(request: Request, name: str) -> list[Key]:
    """What a login as that person from this browser is counted under."""
    if (browser := known_as(request, name)) is not None:
        return [(BY_NAME, "browser", browser)]
    return [(BY_NAME, "name", name), (BY_ADDRESS, "address", network(request.client.host if request.client else ""))]


def network(address: str) -> str:
    """What one customer of a network has: an address, of IPv6 the first half."""
    try:
        ip = ipaddress.ip_address(address)
    except ValueError:
        return "unknown"
    if isinstance(ip, ipaddress.IPv6Address):
        return str(ip.ipv4_mapped or ipaddress.ip_network((int(ip) >> 64 << 64, 64)))
    return str(ip)


def _too_many(wait_s: int) -> Problem:
    minutes = math.ceil(wait_s / 60)
    told = (
        f"too many failed logins: wait {minutes} minute{'s' if minutes > 1 else ''}, or log in with the token your course gave you"
    )
    return Problem(429, "too-many", told, retry_after=wait_s)
