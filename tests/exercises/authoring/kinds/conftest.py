"""The assignment that asks one question of each kind."""

import sys

import pytest

from exercises.authoring.assignments.catalogue import find
from tests.support.assignments import known
from tests.support.toolbox import FOLDER, Toolbox


@pytest.fixture(scope="module")
def toolbox():
    with known(FOLDER) as catalogue:
        assert not catalogue.invalid
        assignment = find("toolbox")
        yield Toolbox(sys.modules["exercises.toolbox.assignment"].notebook, assignment)
