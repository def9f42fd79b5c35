"""Passwords: which ones are good enough, and the argon2 hashes that are kept of them."""

import unicodedata
from functools import cache

from argon2 import PasswordHasher
from argon2.exceptions import InvalidHashError, VerificationError

SHORTEST, LONGEST = 10, 200
_HASHER = PasswordHasher()


class NotGood(ValueError):
    """Not a password to be set; the message says what one is."""


def tidy(password: str, name: str) -> str:
    """The password as it is hashed; NotGood for one that may not be set for the person of that name."""
    password = composed(password)
    if not SHORTEST <= len(password) <= LONGEST:
        raise NotGood(f"a password has {SHORTEST} to {LONGEST} characters")
    if password.strip().casefold() == name.casefold() or len(set(password)) == 1:
        raise NotGood("a password is neither the name nor one character over and over")
    return password


def composed(password: str) -> str:
    """The same however a keyboard composes its letters (NFC)."""
    return unicodedata.normalize("NFC", password)


def hashed(password: str) -> str:
    """What is kept of a tidy password: argon2id with its salt and parameters."""
    return _HASHER.hash(password)


def matches(kept: str | None, password: str) -> bool:
    """Whether it is the password; without one, or with what is no hash, the same work is done for nothing."""
    try:
        return _HASHER.verify(kept or nobodys(), composed(password)) and kept is not None
    except InvalidHashError:
        return matches(None, password)
    except VerificationError:
        return False


def outdated(kept: str) -> bool:
    """Whether it was made with other parameters than hashes are now."""
    return _HASHER.check_needs_rehash(kept)


@cache
def nobodys() -> str:
    """The hash of a password that nobody has."""
    return hashed("of nobody")
