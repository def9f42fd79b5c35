"""Fixtures of the service's tests: ``polhode`` in this process with a warm guest; applications in this
process on a database.
"""

import pytest
from argon2 import PasswordHasher

from service.auth import passwords
from tests.support import command_line
from tests.support.app import App
from tests.support.guests import lend


@pytest.fixture
def warm_guest(sandbox, monkeypatch):
    """Let what is graded in this process run in the tests' own guest; the processes of ``--jobs 2`` start
    theirs as always.
    """
    lend(sandbox, monkeypatch)


@pytest.fixture
def polhode(warm_guest):
    """Run the command line in this process; return exit code, standard output and standard error."""
    return command_line.polhode


@pytest.fixture(scope="module")
def new_app():
    """Start applications with these settings; all of them are stopped at the end of the file."""
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
    """Passwords are hashed by the same algorithm with the least of memory and time; test_passwords has the
    real parameters.
    """
    passwords.dummy_hash.cache_clear()
    monkeypatch.setattr(passwords, "_HASHER", PasswordHasher(time_cost=1, memory_cost=8, parallelism=1))
    yield
    passwords.dummy_hash.cache_clear()
