"""Fixtures of the command's tests: ``polhode`` in this process, with a guest that is warm."""

import os

import pytest

from service import batch
from service.sandbox.sandbox import Sandbox
from tests.support import command_line


@pytest.fixture
def warm_guest(sandbox, monkeypatch):
    """Let what is graded in this process run in the tests' own guest; the processes of ``--jobs 2`` start theirs as always."""
    here = os.getpid()
    monkeypatch.setattr(sandbox, "close", lambda: None)
    monkeypatch.setattr(batch, "Sandbox", lambda walls: sandbox if os.getpid() == here else Sandbox(walls))
    return sandbox


@pytest.fixture
def polhode(warm_guest):
    """Run the command line in this process; return exit code, standard output and standard error."""
    return command_line.polhode
