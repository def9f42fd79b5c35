"""Passwords: which ones are good enough, and the argon2 hashes that are kept of them."""

import asyncio
import unicodedata
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import ParamSpec, TypeVar

from argon2 import PasswordHasher
from argon2.exceptions import InvalidHashError, VerificationError

from service.http.errors import Problem
from service.store.course import credentials
from service.store.database import Database

SHORTEST, LONGEST = 10, 200
_HASHER = PasswordHasher()


class InvalidPassword(ValueError):
    """Not a password to be set; the message says what one is."""


def normalize(password: str, name: str) -> str:
    """The password as it is hashed; NotGood for one that may not be set for the person of that name."""
    password = composed(password)
    if not SHORTEST <= len(password) <= LONGEST:
        raise InvalidPassword(f"a password has {SHORTEST} to {LONGEST} characters")
    if password.strip().casefold() == name.casefold() or len(set(password)) == 1:
        raise InvalidPassword("a password is neither the name nor one character over and over")
    return password


def composed(password: str) -> str:
    """The same however a keyboard composes its letters (NFC)."""
    return unicodedata.normalize("NFC", password)


def hash_password(password: str) -> str:
    """What is kept of a tidy password: argon2id with its salt and parameters."""
    return _HASHER.hash(password)


def matches(kept: str | None, password: str) -> bool:
    """Whether it is the password; without one, or with what is no hash, the same work is done for nothing."""
    try:
        return _HASHER.verify(kept or dummy_hash(), composed(password)) and kept is not None
    except InvalidHashError:
        return matches(None, password)
    except VerificationError:
        return False


def needs_rehash(kept: str) -> bool:
    """Whether it was made with other parameters than hashes are now."""
    return _HASHER.check_needs_rehash(kept)


@cache
def dummy_hash() -> str:
    """The hash of a password that nobody has."""
    return hash_password("of nobody")


P = ParamSpec("P")
T = TypeVar("T")
THREADS, MOST_WAITING = 2, 64  # a hash takes 64 MiB and some 50 ms


class PasswordChecker:
    """Passwords of the persons in the database."""

    def __init__(self, database: Database) -> None:
        self._database, self._waiting = database, 0
        self._threads = ThreadPoolExecutor(THREADS, "passwords")
        self._threads.submit(dummy_hash)

    def stop(self) -> None:
        """Check no more."""
        self._threads.shutdown(wait=False, cancel_futures=True)

    async def check(self, name: str, password: str) -> None:
        """Problem 401 unless that is the person's password, after as long for whatever reason."""
        kept = await credentials.password(self._database, name)
        if not await self._run(matches, kept, password) or kept is None:
            raise Problem(401, "nobody", "name or password is wrong")
        if needs_rehash(kept):
            renewed = await self.hash(composed(password))
            async with self._database.begin() as connection:
                await credentials.renew_hash(connection, name, kept, renewed)

    async def hash(self, password: str) -> str:
        """What is kept of a tidy password."""
        return await self._run(hash_password, password)

    async def _run(self, work: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        if self._waiting >= MOST_WAITING:
            raise Problem(503, "busy", "too many people log in just now: try again in a moment")
        self._waiting += 1
        try:
            return await asyncio.get_running_loop().run_in_executor(self._threads, lambda: work(*args, **kwargs))
        finally:
            self._waiting -= 1
