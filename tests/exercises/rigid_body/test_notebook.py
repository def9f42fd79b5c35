"""The students' notebook, made from the author's: its form, and that no solution is in it."""

import ast
import json
import re

import nbformat
import pytest

from exercises.authoring.assignments.catalogue import find
from exercises.authoring.publishing.publish import BROUGHT

ASSIGNMENT = find("rigid-body")
FILE = ASSIGNMENT.folder / "notebook.ipynb"
AUTHORS = json.loads(FILE.read_text(encoding="utf-8"))
NOTEBOOK = json.loads(ASSIGNMENT.notebook())
CELLS = NOTEBOOK["cells"]
TELLING = ("/ I", "eigvalsh", "arctan2", "m / 12", "set_")
CODE = [cell for cell in CELLS if cell["cell_type"] == "code"]


def test_it_is_valid_by_nbformat():
    for text in (FILE.read_text(encoding="utf-8"), ASSIGNMENT.notebook()):
        nbformat.validate(nbformat.reads(text, as_version=nbformat.NO_CONVERT))


def test_it_is_stored_as_format_4_5_with_an_id_for_every_cell():
    ids = [cell["id"] for cell in CELLS]
    assert (NOTEBOOK["nbformat"], NOTEBOOK["nbformat_minor"]) == (4, 5)
    assert NOTEBOOK["metadata"]["kernelspec"]["name"] == "python3"
    assert len(set(ids)) == len(ids)
    assert FILE.read_text(encoding="utf-8") == json.dumps(AUTHORS, indent=1, ensure_ascii=False) + "\n"


def test_it_was_never_run():
    assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in CODE)


def test_the_servers_addresses_and_packages_stand_open_once_each_and_nothing_else():
    install, rest = _source(CODE[0]).split("\n", 1)
    assert install == "%pip install -q {{KIT_URL}}"
    assert (
        rest == 'import polhode\n\nSERVER = "{{SERVER}}"\n'
        'polhode.connect(SERVER, assignment="rigid-body")\npolhode.login()'
    )
    assert re.findall(r"\{\{\w*\}\}", "\n".join(map(_source, CELLS))) == [
        "{{PACKAGES}}",
        "{{KIT_URL}}",
        "{{SERVER}}",
    ]


def test_a_solution_cell_holds_one_empty_function_and_every_entry_point_has_one():
    names = []
    for cell in _tagged("solution"):
        (function,) = ast.parse(_source(cell)).body
        assert isinstance(function, ast.FunctionDef)
        _, rest = function.body
        assert ast.get_docstring(function), function.name
        assert ast.unparse(rest) == "...", function.name
        names.append(function.name)
    assert len(names) == len(set(names))
    assert set(names) == ASSIGNMENT.functions()


def test_no_other_cell_defines_an_entry_point():
    others = [cell for cell in CODE[1:] if cell not in _tagged("solution")]
    assert not {name for cell in others for name in _defined(_source(cell))} & ASSIGNMENT.functions()


def test_the_server_runs_the_setup_cell_and_nothing_else():
    brought = BROUGHT.format(package="ecp")
    assert ASSIGNMENT.setup.strip() == _source(CODE[1]).replace(brought, "")


def test_every_exercise_has_its_check_cell_in_order():
    assert [_source(cell) for cell in _tagged("check")] == [
        f'polhode.check("{e.number}")' for e in ASSIGNMENT.exercises
    ]


def test_one_cell_submits_every_entry_point():
    (cell,) = (cell for cell in AUTHORS["cells"] if "submit" in cell["metadata"].get("tags", []))
    (call,) = ast.parse(_source(cell)).body
    assert isinstance(call, ast.Expr)
    assert isinstance(call.value, ast.Call)
    assert ast.unparse(call.value.func) == "polhode.submit"
    assert {ast.unparse(argument) for argument in call.value.args} == ASSIGNMENT.functions()


@pytest.mark.parametrize("sample", ["right_all.py", "right_tumble_box_polys.py"])
def test_no_line_of_a_right_sample_that_says_how_is_in_it(sample):
    text = (ASSIGNMENT.folder / "samples" / sample).read_text(encoding="utf-8")
    telling = [line.strip() for line in text.splitlines() if any(word in line for word in TELLING)]
    written = "\n".join(_source(cell) for cell in CELLS)
    assert telling
    assert not [line for line in telling if line in written]


def _source(cell):
    return "".join(cell["source"])


def _tagged(tag):
    return [cell for cell in CODE if tag in cell["metadata"].get("tags", [])]


def _defined(source):
    """Functions of a cell by name, as Python reads them."""
    return {node.name: ast.dump(node) for node in ast.parse(source).body if isinstance(node, ast.FunctionDef)}
