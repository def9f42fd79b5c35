"""The student's line: where the code raised, else where the function is defined, also in the JSON of a
notebook.
"""

import json

import nbformat
import pytest

from polhode.judging.outcome import Ended, SceneEnd
from service.formats.source_lines import SourceLines
from tests.support.reports import graded_file, outcome, report

RAISED = "ZeroDivisionError: division by zero"
ENERGY = outcome("2-energy", "unmeasured", cause=RAISED)


def line(rigid_body, source, file="mine.py", trace=None, one=ENERGY):
    scene_ends = [SceneEnd("motion", Ended.RAISED, RAISED, "raises", trace)]
    return SourceLines(
        graded_file(report([one], scene_ends=scene_ends), file, source=source), rigid_body
    ).line_of(one)


@pytest.mark.parametrize(
    ("source", "number"),
    [
        ("def euler_eqs(t, w, I):\n    pass\n", 1),
        ("x = 1\r\n\r\nasync  def euler_eqs (t):\r\n  pass", 3),
        ("def euler_eqs(): 1\ndef euler_eqs(): 2\n", 2),  # the last is Python's
        ("def euler_eqs(): 1\nclass A:\n    def euler_eqs(self): 2\n", 1),
        ("if True:\n\tdef euler_eqs(): 1\n", 2),
        ("euler_eqs = lambda t, w, I: w\n", 1),
        ("euler_eqs == 1\neuler_eqs_2 = 1\n# def euler_eqs(\n", None),
        ("a = 1\x0cb = 2\ndef euler_eqs(): 1", 2),  # a form feed begins no line
        ("", None),
    ],
)
def test_the_line_of_the_definition(rigid_body, source, number):
    assert line(rigid_body, source) == number


def test_the_innermost_line_of_the_traceback_counts_more(rigid_body):
    source = "def euler_eqs(t, w, I):\n    return other(w)\n\ndef other(w):\n    return w / 0\n"
    trace = (
        '  File "mine.py", line 2, in euler_eqs\n    return other(w)\n  File "mine.py", line 5,'
        f" in other\n{RAISED}\n"
    )
    assert line(rigid_body, source, trace=trace) == 5
    # it raised in another check's scene
    assert line(rigid_body, source, trace=trace, one=outcome("2-energy", "fail")) == 1


@pytest.mark.parametrize(
    "frame", ['"mine.py", line 99999999999999', '"mine.py", line 0', '"/etc/passwd", line 1']
)
def test_no_line_that_the_file_does_not_have(rigid_body, frame):
    assert line(rigid_body, "\ndef euler_eqs(): 1", trace=f"  File {frame}, in euler_eqs\n{RAISED}\n") == 2


def notebook(*cells):
    made = nbformat.v4.new_notebook(
        cells=[nbformat.v4.new_markdown_cell("# def euler_eqs(\n"), *map(nbformat.v4.new_code_cell, cells)]
    )
    return nbformat.writes(made)


@pytest.mark.parametrize("indent", [1, None])
@pytest.mark.parametrize("joined", [False, True])
def test_a_line_of_a_cell_is_one_of_the_file(rigid_body, indent, joined):
    document = json.loads(
        notebook("import numpy as np", 'a = "def"\n\ndef euler_eqs(t, w, I):\n    é = w / 0\n    return é')
    )
    if joined:
        document["cells"] = [cell | {"source": "".join(cell["source"])} for cell in document["cells"]]
    source = json.dumps(document, indent=indent)
    defined = line(rigid_body, source, "mine.ipynb")
    assert "def euler_eqs(t" in source.split("\n")[defined - 1]
    raised = line(
        rigid_body, source, "mine.ipynb", trace=f'  File "cell 2", line 4, in euler_eqs\n{RAISED}\n'
    )
    assert "w / 0" in source.split("\n")[raised - 1]
    if indent and not joined:
        assert raised == defined + 1


@pytest.mark.parametrize(
    "source",
    [
        *(
            "",
            "[]",
            "{",
            '{"cells": 3}',
            '{"cells": [{"cell_type": "code", "source": [1]}]}',
            '{"cells": [{"cell_type": "code"}]}',
        ),
        *(
            '{"cells": [{"cell_type": "code", "source": {"def euler_eqs(": 1}}]}',
            "[" * 100_000,
            '{"cells": "def euler_eqs("}',
        ),
    ],
)
def test_what_is_no_notebook_has_no_lines(rigid_body, source):
    assert line(rigid_body, source, "mine.ipynb") is None


def test_a_check_that_the_assignment_does_not_have_any_more_is_nowhere(rigid_body):
    assert line(rigid_body, "def euler_eqs(): 1", one=outcome("2-of-old", "fail")) is None
