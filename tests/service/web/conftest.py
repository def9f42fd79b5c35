"""For tests of pages: the application in this process, on a database of the module's own; it asks everybody for a token."""

import pytest
from argon2 import PasswordHasher

from service import passwords
from tests.support.app import App


@pytest.fixture(scope="session")
def new_app():
    """Start applications with these settings; all of them are stopped at the end."""
    apps = []

    def start(**settings):
        apps.append(App(**settings))
        return apps[-1]

    yield start
    for app in apps:
        app.stop()


@pytest.fixture(scope="module")
def server(url):
    """An application without workers; ``real_server`` is a process that has some."""
    started = App(database_url=url)
    yield started
    started.stop()


@pytest.fixture
def cheap_hashes(monkeypatch):
    """Passwords are hashed by the same algorithm with the least of memory and time; test_passwords has the real parameters."""
    passwords.nobodys.cache_clear()
    monkeypatch.setattr(passwords, "_HASHER", PasswordHasher(time_cost=1, memory_cost=8, parallelism=1))
    yield
    passwords.nobodys.cache_clear()
