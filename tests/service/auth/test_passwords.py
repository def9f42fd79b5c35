"""Hashes of passwords: what they cost, and that a guess costs the same whether or not there is a password to
guess.
"""

import argon2
import pytest
from argon2 import PasswordHasher, extract_parameters

from service.auth import passwords

PASSWORD = "correct horse battery"


def test_a_hash_is_as_hard_to_compute_as_rfc_9106_recommends():
    for kept in (passwords.hash_password(PASSWORD), passwords.dummy_hash()):
        assert extract_parameters(kept) == argon2.profiles.RFC_9106_LOW_MEMORY and kept.startswith(
            "$argon2id$"
        )
        assert not passwords.needs_rehash(kept)
    assert passwords.needs_rehash(PasswordHasher(time_cost=1, memory_cost=1024, parallelism=1).hash(PASSWORD))


class Counting(PasswordHasher):
    """A hasher that keeps the parameters of each hash that it computed to verify a password."""

    def __init__(self):
        super().__init__()
        self.computed = []

    def verify(self, hash, password):
        try:
            return super().verify(hash, password)
        except argon2.exceptions.InvalidHashError:
            hash = None  # refused without a computation
            raise
        finally:
            if hash is not None:
                self.computed.append(extract_parameters(hash))


@pytest.mark.parametrize(
    ("kept", "guess", "matches"),
    [
        ("hash", "wrong password", False),
        (None, "of nobody", False),
        ("no hash", "of nobody", False),
        ("hash", PASSWORD, True),
    ],
)
def test_checking_nobodys_password_is_as_much_work(monkeypatch, kept, guess, matches):
    hasher = Counting()
    monkeypatch.setattr(passwords, "_HASHER", hasher)
    kept = passwords.hash_password(PASSWORD) if kept == "hash" else kept
    assert passwords.matches(kept, guess) is matches
    assert hasher.computed == [argon2.profiles.RFC_9106_LOW_MEMORY]
