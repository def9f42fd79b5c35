"""A published notebook is imported, and submissions of it are graded in the sandbox by the published cells."""

from dataclasses import replace

import pytest

from ecp.judge import Verdict
from exercises.importing import imported
from service.grading.grade import grade
from service.grading.submission import Submission
from tests.support.assignments import known
from tests.support.course_notebook import FILE, LABELS
from tests.support.course_shape import CHECKS, HIDDEN, SETUP, SOLUTIONS, course_notebook, published, written


def imported_folder(folder, name, text):
    file = written(folder / "in", f"{name}.ipynb", text)
    made = imported(file)
    home = folder / made.slug.replace("-", "_")
    written(home, file.name, text)
    written(home, "assignment.py", made.text)
    return home


@pytest.fixture(scope="module")
def sums(tmp_path_factory):
    home = imported_folder(tmp_path_factory.mktemp("imported"), "small-sums", published())
    with known(home) as found:
        assert not found.invalid, found.invalid
        yield found.valid["small-sums"]


def report(assignment, sandbox, text):
    return grade(Submission(text, "mine.ipynb"), assignment, sandbox, 1).report


def marks(report):
    return "".join(outcome.verdict.value[0] for outcome in report.outcomes())


def test_notebook_2_6_as_published_and_filled_in_prints_its_nine_lines(tmp_path, sandbox):
    with known(imported_folder(tmp_path, "rigid-rotation", course_notebook())) as found:
        made = report(found.valid["rigid-rotation"], sandbox, FILE.read_text())
    assert [outcome.label for outcome in made.outcomes()] == list(LABELS) and marks(made) == "p" * 9
    assert [outcome.line for outcome in made.outcomes()] == made.lines().split("\n")
    assert all(o.self_reported and not o.counted and o.points == o.earned == 0 for o in made.outcomes())
    assert "0 of 0 points (public checks: 0 of 0); 9 of 9 self-reported lines ✓" in made.text() and not made.passed


def test_filled_in_every_line_is_judged(sums, sandbox):
    made = report(sums, sandbox, published(SOLUTIONS))
    assert marks(made) == "ppppp"
    assert [o.detail for o in made.outcomes()][:2] == ["got 20 vs expected 20 (rtol=1e-06, atol=1e-09)", "sum 10"]
    assert made.outcomes()[2].label == "2 to the power 3"  # the last of four
    assert made.outcomes()[2].tolerance.rtol == 1e-12 and "self-reported" in made.outcomes()[2].tolerance.reason


def test_the_first_wrong_of_several_claims_of_one_line_is_shown(sums, sandbox):
    made = report(sums, sandbox, published((SOLUTIONS[0], "powers = [1, 2, 5, 9]\n", SOLUTIONS[2])))
    assert marks(made) == "ppfpp" and made.outcomes()[2].label == "2 to the power 2"


def test_as_downloaded_nothing_is_measured(sums, sandbox):
    made = report(sums, sandbox, published())
    assert marks(made) == "uuuuu"
    assert "name 'total' is not defined" in made.outcomes()[0].cause


def test_a_cell_that_fails_leaves_its_own_lines(sums, sandbox):
    made = report(sums, sandbox, published((SOLUTIONS[0], "powers = 1 / 0\n", SOLUTIONS[2])))
    assert marks(made) == "ppupp"
    assert "ZeroDivisionError" in made.outcomes()[2].cause and "NameError" in made.outcomes()[2].cause


def test_a_cell_that_never_ends_costs_no_other(sums, sandbox):
    made = report(replace(sums, load_s=0.3), sandbox, published((SOLUTIONS[0], "while True: pass\n", SOLUTIONS[2])))
    assert marks(made) == "ppupp"


WRONG = ("total = 11\n", *SOLUTIONS[1:])
PASSING = 'validate.close(20, 20, "twice the sum is 20")\nvalidate.check(True, "the sum is positive", "sure")\n'


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (published(WRONG, checks=(PASSING, *CHECKS[1:])), "fpppp"),  # the validation cell edited
        (published(WRONG, checks=(None, None, None)), "fpppp"),  # or deleted
        (published(WRONG, setup=SETUP.replace("2 * x", "20")), "fpppp"),  # Setup edited
        (published(WRONG, setup="import numpy as np\n"), "fpppp"),
        (published(("total = 11\nvalidate.close = lambda *a, **k: True\n", *SOLUTIONS[1:])), "fpppp"),
        (published(("total = 11\nimport ecp.judge\necp.judge.close = None\nvalidate = None\n", *SOLUTIONS[1:])), "fpppp"),
        (published((f"total = 11\n{PASSING}", *SOLUTIONS[1:])), "fpppp"),  # the same lines from the student's own cell
        (published(("total = 11\ndef double(x): return 20\n", *SOLUTIONS[1:])), "ppppp"),  # redefines an instrument: self-reported
        (published((HIDDEN, *SOLUTIONS[1:]), checks=(f"total = 10\n{CHECKS[0]}", *CHECKS[1:])), "ppppp"),  # solved in that cell
        (published(("import os\nos._exit(0)\n", *SOLUTIONS[1:])), "uuuuu"),
    ],
)
def test_an_edited_copy_changes_no_line_but_by_its_numbers(sums, sandbox, text, expected):
    assert marks(report(sums, sandbox, text)) == expected


def test_cells_without_ids_as_the_kit_sends_them_and_a_python_file(sums, sandbox):
    cells = [SETUP, SOLUTIONS[0], CHECKS[0], "x = 3\n", SOLUTIONS[1], CHECKS[1], SOLUTIONS[2], CHECKS[2]]
    bare = "".join(cells)
    assert marks(grade(Submission(bare, "mine.py"), sums, sandbox, 1).report) == "ppppp"


def test_a_truth_or_trust_makes_a_line_count(tmp_path, sandbox):
    home = imported_folder(tmp_path, "strong-sums", published())
    text = (home / "assignment.py").read_text()
    text = text.replace('line("twice the sum is 20")', 'line("twice the sum is 20", truth=20, points=3)')
    text = text.replace('line("the area is positive")', 'line("the area is positive", trust=True)')
    text = text.replace('line("the series is near π")', 'line("the series is near π", truth=lambda: 3.0)')
    (home / "assignment.py").write_text(text)
    with known(home) as found:
        made = report(found.valid["strong-sums"], sandbox, published(SOLUTIONS))
        assert found.valid["strong-sums"].max_points() == 5
        again = report(
            found.valid["strong-sums"], sandbox, published(SOLUTIONS, checks=('validate.close(20, 20, "x")\n', *CHECKS[1:]))
        )
    assert marks(made) == "pppfp" and (made.score, made.max_score) == (4, 5)
    assert marks(again) == "pppfp"
    assert {o.verdict for o in made.outcomes() if o.self_reported} == {Verdict.PASS}
