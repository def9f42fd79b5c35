"""Rate limits of failed logins and of unknown codes of notebook logins, by person and by address, and of
started notebook logins, by address. Each server process counts separately.

A browser in which the person has logged in before has its own counter, so guesses from elsewhere do not lock
the person out of it. In a new browser the person waits as the attacker does, at most one window. Tokens
cannot be guessed; logins by token are not limited.
"""

import math
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager

from fastapi import Request
from limits import RateLimitItem, RateLimitItemPerMinute
from limits.storage import MemoryStorage
from limits.strategies import MovingWindowRateLimiter

from service.auth.cookies import Cookies
from service.http.errors import Problem
from service.http.requests import network

BY_NAME, BY_ADDRESS = RateLimitItemPerMinute(10, 15), RateLimitItemPerMinute(100, 10)
MOST_AT_ONCE = 32  # passwords from one address that wait to be checked: a part of all that may wait
STARTS = RateLimitItemPerMinute(300)  # a class behind one address starts its logins within a minute
JUMP_S = 5.0  # less is a clock that is being corrected
Key = tuple[RateLimitItem, str, str]


class LoginRateLimiter:
    """Counts failed, pending and started logins."""

    def __init__(self) -> None:
        self._storage = MemoryStorage()
        self._windows = MovingWindowRateLimiter(self._storage)
        self._pending: Counter[Key] = Counter()
        self._clock = _clock()

    @contextmanager
    def guard(self, *keys: Key, failure: int = 401) -> Iterator[None]:
        """Guard one login, which fails by raising a Problem with the status ``failure``: 401, or 404 for an
        unknown code.

        Raises Problem 429 if the failed and pending logins of a key reach its limit.
        """
        self._notice_jump()
        for key in keys:
            if key[1] == "address" and self._pending[key] >= MOST_AT_ONCE:
                raise Problem(429, "too-many", AT_ONCE, retry_after=1)
            until, left = self._windows.get_window_stats(*key)
            if left <= self._pending[key]:
                wait_s = math.ceil(until - time.time()) if left <= 0 else 1
                raise _too_many(max(wait_s, 1), failure)
        self._pending.update(keys)
        try:
            yield
        except Problem as problem:
            if problem.status == failure:
                for key in keys:
                    self._windows.hit(*key)
            raise
        finally:
            self._pending.subtract(keys)
            for key in keys:
                if self._pending[key] <= 0:
                    del self._pending[key]

    def _notice_jump(self) -> None:
        """Forget all counts after a jump of the clock, by which they would count too long or too little."""
        before, self._clock = self._clock, _clock()
        if abs(self._clock - before) > JUMP_S:
            self._storage.reset()

    def start(self, request: Request) -> None:
        """Count a started notebook login. Raises Problem 429 if its address has started too many within a
        minute.
        """
        self._notice_jump()
        address = _address(request)
        if not self._windows.hit(STARTS, address):
            until, _ = self._windows.get_window_stats(STARTS, address)
            wait_s = max(1, math.ceil(until - time.time()))
            detail = (
                f"too many logins were started from your network: wait {wait_s} s, then run polhode.login()"
                " again"
            )
            raise Problem(429, "too-many", detail, retry_after=wait_s)


def _clock() -> float:
    """Return the difference between the clock, which may jump, and the time that has passed."""
    return time.time() - time.monotonic()


def keys_of(request: Request, cookies: Cookies, name: str) -> list[Key]:
    """Return the keys that count a login as ``name`` from this browser."""
    if (browser := cookies.known_browser(name)) is not None:
        return [(BY_NAME, "browser", browser)]
    return [(BY_NAME, "name", name), (BY_ADDRESS, "address", _address(request))]


def keys_of_code(request: Request, name: str | None) -> list[Key]:
    """Return the keys that count an unknown code from this address and, if known, of the person ``name``."""
    by_person = [] if name is None else [(BY_NAME, "codes of person", name)]
    return [(BY_ADDRESS, "codes of address", _address(request)), *by_person]


def _address(request: Request) -> str:
    return network(request.client.host if request.client else "")


AT_ONCE = "too many people log in from your network at this moment: try again in a second"


def _too_many(wait_s: int, failure: int) -> Problem:
    minutes = math.ceil(wait_s / 60)
    wait = f"wait {minutes} minute{'s' if minutes > 1 else ''}"
    detail = (
        f"too many unknown codes: {wait}, then run polhode.login() again"
        if failure == 404
        else f"too many failed logins: {wait}, or log in with the token from your course"
    )
    return Problem(429, "too-many", detail, retry_after=wait_s)
