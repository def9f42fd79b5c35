"""Passwords: validation, argon2 hashes and their verification."""

import asyncio
import unicodedata
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import ParamSpec, TypeVar

from argon2 import PasswordHasher
from argon2.exceptions import InvalidHashError, VerificationError

from service.http.errors import Problem
from service.store.database import Database
from service.store.people import credentials

SHORTEST, LONGEST = 10, 200
THREADS, MOST_WAITING = 2, 64  # a hash takes 64 MiB and about 50 ms
_HASHER = PasswordHasher()
P = ParamSpec("P")
T = TypeVar("T")


class InvalidPassword(ValueError):
    """The password may not be set; the message states the rule."""


def normalize(password: str, name: str) -> str:
    """Return the password as it is hashed. Raises InvalidPassword if the person ``name`` may not set it."""
    password = to_nfc(password)
    if not SHORTEST <= len(password) <= LONGEST:
        raise InvalidPassword(f"choose a password of {SHORTEST} to {LONGEST} characters")
    if password.strip().casefold() == name.casefold() or len(set(password)) == 1:
        raise InvalidPassword("choose a password that is neither your name nor one repeated character")
    return password


def to_nfc(password: str) -> str:
    """Return the password in NFC, so that the keyboard's way of composing letters does not matter."""
    return unicodedata.normalize("NFC", password)


def hash_password(password: str) -> str:
    """Return the argon2id hash of a normalized password, with its salt and parameters."""
    return _HASHER.hash(password)


def matches(stored: str | None, password: str) -> bool:
    """Return whether the password matches the stored hash.

    Without a valid hash, take the same time and return False.
    """
    try:
        return _HASHER.verify(stored or dummy_hash(), to_nfc(password)) and stored is not None
    except InvalidHashError:
        return matches(None, password)
    except VerificationError:
        return False


def needs_rehash(stored: str) -> bool:
    """Return whether the hash has outdated parameters."""
    return _HASHER.check_needs_rehash(stored)


@cache
def dummy_hash() -> str:
    """Return a valid hash that belongs to no person."""
    return hash_password("dummy")


class PasswordChecker:
    """Checks and hashes passwords in threads, because a hash takes about 50 ms."""

    def __init__(self, database: Database) -> None:
        self._database, self._waiting = database, 0
        self._threads = ThreadPoolExecutor(THREADS, "passwords")
        self._threads.submit(dummy_hash)

    def stop(self) -> None:
        """Cancel pending checks."""
        self._threads.shutdown(wait=False, cancel_futures=True)

    async def check(self, name: str, password: str) -> None:
        """Raise Problem 401 if it is not the person's password.

        The time taken does not reveal the reason.
        """
        stored = await credentials.password(self._database, name)
        if not await self._run(matches, stored, password) or stored is None:
            raise Problem(401, "nobody", "name or password is wrong: try again, or log in with a token")
        if needs_rehash(stored):
            renewed = await self.hash(to_nfc(password))
            async with self._database.begin() as connection:
                await credentials.renew_hash(connection, name, stored, renewed)

    async def hash(self, password: str) -> str:
        """Return the hash of a normalized password."""
        return await self._run(hash_password, password)

    async def _run(self, work: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        if self._waiting >= MOST_WAITING:
            raise Problem(503, "busy", "too many people are logging in: try again in a moment")
        self._waiting += 1
        try:
            return await asyncio.get_running_loop().run_in_executor(
                self._threads, lambda: work(*args, **kwargs)
            )
        finally:
            self._waiting -= 1
