"""The text of assignment.py says of each line whether it counts, and why."""

import numpy as np
import pytest

from exercises.authoring.importing.assignment_file import Findings, assignment_file
from exercises.authoring.importing.importing import read_published
from tests.support.course_shape import published, written


@pytest.fixture
def sums(tmp_path):
    return read_published(written(tmp_path, "small-sums.ipynb", published()), tmp_path / "course", {})


def test_without_a_dry_run_every_line_is_self_reported(sums):
    text = assignment_file(sums, Findings())
    assert text.count("# self-reported") == 5 and "truth=" not in text.replace("truth=…", "")
    assert "load_s=60" in text and "cpu_s=600" in text and "memory_mb=2048," in text


def test_what_a_dry_run_found_stands_in_the_lines(sums):
    twice, positive, _, near, _ = sums.taken
    truths = {twice: np.array(20.0), near: np.full(30, 0.5)}
    text = assignment_file(sums, Findings(without_student=[positive], truths=truths))
    assert 'ask.line("twice the sum is 20", truth=20.0, shown=True)' in text
    assert "# value shown: 20 stands in the notebook; accept=True lets the line count\n" in text
    assert 'ask.line("the sum is positive", given=True)' in text
    assert 'ask.line("the series is near π", truth=lambda: np.full((30,), 0.5), shown=True)' in text
    assert "also with area = np.pi" in text and "\nimport numpy as np\n" in text
    compile(text, "assignment.py", "exec")


def test_a_truth_of_many_different_numbers_is_left_to_the_author(sums):
    text = assignment_file(sums, Findings(truths={sums.taken[0]: np.arange(17.0)}))
    assert "shown=True" not in text and "truth=… for 20" in text


def test_budgets_are_five_times_what_the_authors_cells_take_and_memory_twice():
    found = Findings(cell_s=30.0, cpu_s=90.0, peak_mb=700.0, has_solutions=True).budgets()
    assert found == {"load_s": 150.0, "cpu_s": 450.0, "memory_mb": 1536}
    assert Findings(has_solutions=True).budgets() == {"load_s": 10.0, "cpu_s": 60.0}
    assert Findings(cell_s=1.0, cpu_s=2.0, peak_mb=120.0).budgets() == {
        "load_s": 60.0,
        "cpu_s": 600.0,
        "memory_mb": 2048,
    }
