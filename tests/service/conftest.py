"""Fixtures of the command's tests: ``polhode`` in this process, with a guest that is warm."""

import pytest

from tests.support import command_line
from tests.support.guests import lend


@pytest.fixture
def warm_guest(sandbox, monkeypatch):
    """Let what is graded in this process run in the tests' own guest; the processes of ``--jobs 2`` start theirs as always."""
    lend(sandbox, monkeypatch)


@pytest.fixture
def polhode(warm_guest):
    """Run the command line in this process; return exit code, standard output and standard error."""
    return command_line.polhode
