"""Checking passwords: the hashing runs in a few threads, for a bounded number of people at a time."""

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import ParamSpec, TypeVar

from service import passwords
from service.store import credentials
from service.store.database import Database
from service.web.problems import Problem

P = ParamSpec("P")
T = TypeVar("T")
THREADS, MOST_WAITING = 2, 64  # a hash takes 64 MiB and some 50 ms


class Passwords:
    """Passwords of the persons in the database."""

    def __init__(self, database: Database) -> None:
        self._database, self._waiting = database, 0
        self._threads = ThreadPoolExecutor(THREADS, "passwords")
        self._threads.submit(passwords.nobodys)

    def stop(self) -> None:
        """Check no more."""
        self._threads.shutdown(wait=False, cancel_futures=True)

    async def check(self, name: str, password: str) -> None:
        """Problem 401 unless that is the person's password, after as long for whatever reason."""
        kept = await credentials.password(self._database, name)
        if not await self._run(passwords.matches, kept, password) or kept is None:
            raise Problem(401, "nobody", "name or password is wrong")
        if passwords.outdated(kept):
            renewed = await self.hash(passwords.composed(password))
            async with self._database.begin() as connection:
                await credentials.renew_hash(connection, name, kept, renewed)

    async def hash(self, password: str) -> str:
        """What is kept of a tidy password."""
        return await self._run(passwords.hashed, password)

    async def _run(self, work: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        if self._waiting >= MOST_WAITING:
            raise Problem(503, "busy", "too many people log in just now: try again in a moment")
        self._waiting += 1
        try:
            return await asyncio.get_running_loop().run_in_executor(self._threads, lambda: work(*args, **kwargs))
        finally:
            self._waiting -= 1
