"""The author's notebook: its Setup, and its errors as errors of the declaration."""

import pytest

from exercises.authoring.questions.author_notebook import Cell, given_constants, read, setup
from service.grading.grade import grade
from service.grading.submission import Submission
from tests.support.assignments import change, known
from tests.support.author_notebooks import CELLS, code, markdown, write

NAMES = {"speed", "height"}


def test_the_setup_runs_before_a_submission_in_the_sandbox(tmp_path, sandbox):
    shown = code("from IPython.display import HTML\ndisplay(HTML('<b>Falling</b>'))\nget_ipython()")
    folder = write(tmp_path, [*CELLS[:3], shown, *CELLS[3:]])
    source = "def speed(t, g): return SIGN * np.multiply(g, t)\ndef height(t, g, h): return h - g * t**2 / 2"
    with known(folder) as found:
        assert found.valid["falling"].setup.startswith("pass\nimport numpy as np\n\nfrom IPython")
        report = grade(Submission(source), found.valid["falling"], sandbox, 1).report
    assert report.passed, report.text()


@pytest.mark.parametrize(
    ("cells", "expected"),
    [
        (
            [
                Cell("code", "a = 1"),
                Cell("markdown", "## 0. Setup"),
                Cell("code", "b = 1"),
                Cell("markdown", "## Next"),
            ],
            "b = 1",
        ),
        (
            [
                Cell("markdown", "### Setup:"),
                Cell("code", "a = 1"),
                Cell("markdown", "#### More"),
                Cell("code", "b = 1"),
            ],
            "a = 1\n\nb = 1",
        ),
        (
            [
                Cell("markdown", "# Setup"),
                Cell("code", "a = 1"),
                Cell("code", "def speed(): return 1"),
                Cell("code", "b = 1"),
            ],
            "a = 1",
        ),
        ([Cell("code", "a = 1"), Cell("code", "b = 2", tags=("solution",)), Cell("code", "c = 3")], "a = 1"),
        ([Cell("code", "a = 1"), Cell("code", "if True:\n    speed = 2")], "a = 1"),
        (
            [
                Cell("markdown", "```\n# Setup\n```"),
                Cell("code", "a = 1"),
                Cell("raw", "text"),
                Cell("code", "%%bash\nls"),
            ],
            "a = 1",
        ),
        ([Cell("markdown", "## The experimental setup"), Cell("code", "a = 1")], "a = 1"),
        (
            [Cell("markdown", "## Setup"), Cell("code", "%%time\nfiles = !ls\n%pip install x\nb = 1")],
            "files = get_ipython()\npass\nb = 1",
        ),
    ],
)
def test_the_setup_is_the_code_below_its_heading_or_before_the_first_solution(cells, expected):
    assert (
        setup([*cells, Cell("code", "def height(): return 1"), Cell("code", "z = 1")], NAMES).strip()
        == expected
    )


@pytest.mark.parametrize(
    ("spoil", "errors"),
    [
        (lambda folder: (folder / "fall.ipynb").unlink(), ["fall.ipynb is missing"]),
        (
            lambda folder: (folder / "fall.ipynb").write_bytes(b"\xff"),
            ["fall.ipynb cannot be read as UTF-8 text"],
        ),
        (
            lambda folder: (folder / "fall.ipynb").write_text("{"),
            ["fall.ipynb is not a Jupyter notebook (format 4): save it again"],
        ),
        (
            lambda folder: (folder / "fall.ipynb").write_text('{"worksheets": []}'),
            ["fall.ipynb is not a Jupyter notebook"],
        ),
        (
            lambda folder: (folder / "fall.ipynb").write_text('{"cells": []}'),
            ["fall.ipynb has no code cells"],
        ),
        (
            lambda folder: change(folder / "fall.ipynb", "def height", "def hight"),
            ["assignment.py line 17: no cell of the notebook defines the function height"],
        ),
        (
            lambda folder: (
                change(folder / "fall.ipynb", "h - g", "h -* g"),
                change(folder / "fall.ipynb", "def speed", "def sped"),
            ),
            [
                "assignment.py line 9: no cell of the notebook defines the function speed",
                "assignment.py line 17: no cell of the notebook defines the function height",
                "fall.ipynb: code cell 5 is not valid Python: line 2: invalid syntax",
            ],
        ),
        (
            lambda folder: (
                change(folder / "fall.ipynb", "def height", "%config x = 1\\ndef height"),
                change(folder / "fall.ipynb", "h - g", "h -* g"),
            ),
            [
                "assignment.py line 17: no cell of the notebook defines the function height",
                "code cell 5 is not valid Python: line 3: invalid syntax",
            ],
        ),
    ],
)
def test_an_error_of_the_notebook_is_one_of_the_declaration(tmp_path, spoil, errors):
    folder = write(tmp_path)
    spoil(folder)
    with known(folder) as found:
        (invalid,) = found.invalid.values()
    assert len(invalid.errors) == len(errors)
    for error, expected in zip(invalid.errors, errors, strict=True):
        assert expected in error


def test_an_indented_cell_and_a_list_of_lines_are_read(tmp_path):
    folder = write(tmp_path, [code(["  a = 1\n", "  b = 2"]), markdown(["# A\n", "b"])])
    assert [cell.source for cell in read(folder / "fall.ipynb")] == ["a = 1\nb = 2", "# A\nb"]


def test_constants_of_given_cells_behind_the_setup_need_no_solution():
    cells = [
        Cell("markdown", "## Setup"),
        Cell("code", "import numpy as np"),
        Cell("markdown", "## Exercise 1"),
        Cell("code", "def speed(t): return 9.81 * t", tags=("solution",)),
        Cell("code", "g = 9.81\nt = np.linspace(0, 1, 5)\nfast = speed(t)\nfaster = fast + g\nprint(g)"),
        Cell("code", "for k in range(3):\n    g += k\nend = int(3)\ndef double(x):\n    return 2 * x"),
    ]
    given = given_constants(cells, {"speed"})
    assert given.split("\n\n") == [
        "\ng = 9.81\n".rstrip("\n"),
        "t = np.linspace(0, 1, 5)",
        "def double(x):\n    return 2 * x\n",
    ]
