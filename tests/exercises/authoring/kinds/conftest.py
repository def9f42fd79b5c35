"""The assignment that asks one question of each kind."""

import sys

import pytest

from tests.support.assignments import known
from tests.support.toolbox import FOLDER, Toolbox


@pytest.fixture(scope="module")
def toolbox():
    with known(FOLDER) as catalogue:
        assert not catalogue.invalid
        yield Toolbox(sys.modules["exercises.toolbox.assignment"].notebook, catalogue.valid["toolbox"])
