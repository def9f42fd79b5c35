"""Packages that are installed and not the assignment's are not there for a submission, at both levels."""

import json

import pytest

from exercises.authoring.assignments.assignment import ArraySpec
from service.sandbox.job import Cell, Job, SceneRequest

PLAYS = "def ask(student, inputs):\n    return {'x': student['f']()}"
TRIES = """
import importlib.util, json
try:
    import {name}
except Exception as error:
    told = [type(error).__name__, str(error)]
print(json.dumps([*told, importlib.util.find_spec("{package}") is None]))
f = float
"""


@pytest.mark.parametrize("name", ["pydantic", "pydantic.fields", "six", "psycopg_pool"])
def test_a_package_that_the_assignment_lacks_is_not_there(name, either_sandbox):
    package = name.partition(".")[0]
    asked = SceneRequest("one", "ask", "f", {}, {"x": ArraySpec(())}, 2.0, None)
    cell = Cell("submission.py", TRIES.format(name=name, package=package))
    played = either_sandbox.play(Job("", PLAYS, (cell,), ("f",), (asked,)))
    assert played.finished("one")
    assert json.loads(played.stdout) == ["ModuleNotFoundError", f"No module named '{package}'", True]
