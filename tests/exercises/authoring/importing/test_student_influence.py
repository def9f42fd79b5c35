"""An expected value that no student's cell can influence is told from one that it can."""

import pytest

from exercises.authoring.importing.importing import read_published
from exercises.authoring.importing.student_influence import influenced, is_independent, is_shown
from tests.support.course_shape import notebook, written

SETUP = """
import numpy as np
from ecp import validate
from scipy.constants import hbar
N, G = 4, 9.81
rng = np.random.default_rng(1)
data = rng.normal(size=N)
filled = np.zeros(N)
def double(x): return 2 * x
def of_student(x): return answer + x
def noisy(): return rng.normal()
"""


def line(tmp_path, call, solution="# your answer\n"):
    cells = [
        ("code", "s", [], SETUP),
        ("code", "a", ["solution"], solution),
        ("code", "v", ["validation"], f"near = 3.0 + np.sqrt(2)\nwide = answer\nvalidate.{call}\n"),
    ]
    made = read_published(written(tmp_path, "one.ipynb", notebook(*cells)), tmp_path / "course", {})
    (taken,) = made.taken
    return taken, made.cells


@pytest.mark.parametrize(
    "expected",
    ["2.0", "np.pi", "hbar", "N", "double(G)", "data.sum()", "near", "[1, 2, N]", "np.linalg.norm(data)"],
)
def test_what_given_cells_alone_compute_can_be_a_truth(tmp_path, expected):
    taken, cells = line(tmp_path, f'close(answer, {expected}, "a")')
    assert is_independent(taken, influenced(cells))


@pytest.mark.parametrize(
    "expected", ["answer", "2 * answer", "of_student(1)", "wide", "filled", "noisy()", "rng.normal()"]
)
def test_what_a_students_cell_can_influence_cannot(tmp_path, expected):
    taken, cells = line(tmp_path, f'close(1.0, {expected}, "a")')
    assert not is_independent(taken, influenced(cells))


@pytest.mark.parametrize("call", ['check(answer > 1, "a")', 'close(answer, 1.0, "a", rtol=N)'])
def test_only_close_with_written_tolerances_can_have_a_truth(tmp_path, call):
    taken, cells = line(tmp_path, call)
    assert not is_independent(taken, influenced(cells))


def test_a_name_that_the_authors_solution_binds_is_the_students(tmp_path):
    taken, cells = line(tmp_path, 'close(answer, N, "a")', solution="answer = N = 4\n")
    assert not is_independent(taken, influenced(cells))


@pytest.mark.parametrize(
    ("arguments", "shown"),
    [
        ("double(answer), 2.0", True),
        ("double(answer), np.pi / 2", True),
        ("double(answer), [N, G]", True),
        ("double(answer), near", True),
        ("double(answer), double(G)", False),
        ("answer, double(G)", True),  # a student can write answer = double(G)
    ],
)
def test_a_value_that_stands_in_the_notebook_is_shown(tmp_path, arguments, shown):
    taken, cells = line(tmp_path, f'close({arguments}, "a")')
    assert is_shown(taken, cells) is shown
