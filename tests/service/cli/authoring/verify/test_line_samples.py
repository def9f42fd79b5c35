"""`polhode verify` of an imported notebook: untouched, with the shown values copied, and solved."""

import pytest

from service.cli.__main__ import main
from tests.support.assignments import change, known
from tests.support.course_shape import CHECKS, SOLUTIONS, published, written

ALWAYS = 'validate.check(np.pi > 3, "π is more than 3")\n'


@pytest.fixture
def imported(tmp_path, capsys):
    """Return a function that imports a notebook with these solutions and returns its folder."""

    def run(**cells):
        file = written(tmp_path, "small-sums.ipynb", published(**cells))
        with known():
            assert main(["import-notebook", str(file), "--into", str(tmp_path / "into")]) == 0
        capsys.readouterr()
        return tmp_path / "into" / "small_sums"

    return run


def verified(folder, capsys):
    with known(folder):
        return main(["verify", str(folder)]), capsys.readouterr().out


def test_an_imported_notebook_is_verified_at_once(imported, capsys):
    code, printed = verified(imported(checks=(ALWAYS + CHECKS[0], *CHECKS[1:])), capsys)
    assert code == 0 and "✓  untouched.ipynb\n✓  copied_values.ipynb\n" in printed
    assert "2 of 2 samples of its lines as expected; 0 of 6 lines count\nno solved notebook" in printed


def test_the_authors_solutions_must_make_every_line_right(imported, capsys):
    folder = imported(solutions=SOLUTIONS)
    assert verified(folder, capsys) == (
        0,
        "✓  untouched.ipynb\n✓  copied_values.ipynb\n✓  your_solutions.ipynb\n"
        "small-sums: 3 of 3 samples of its lines as expected; 0 of 5 lines count\n",
    )
    change(folder / "small-sums.ipynb", "range(5)", "range(6)")
    code, printed = verified(folder, capsys)
    assert code == 1 and "✗  your_solutions.ipynb\n     ✗  twice the sum is 20   [got 30 vs" in printed


def test_a_solved_notebook_among_the_samples_is_the_authors_too(imported, capsys):
    folder = imported()
    written(folder / "samples", "right_all.ipynb", published((*SOLUTIONS[:2], "area = 0\n")))
    code, printed = verified(folder, capsys)
    assert code == 1 and "✗  right_all.ipynb\n     ✗  the series is near π" in printed


def test_a_line_that_a_copy_makes_right_must_be_accepted_to_count(imported, capsys):
    folder = imported()
    change(folder / "assignment.py", "shown=True)", "shown=True, accept=True)")
    assert verified(folder, capsys)[0] == 0
    change(folder / "assignment.py", "shown=True, accept=True)", "shown=True, trust=True)")
    assert verified(folder, capsys)[0] == 0, "a value that is shown carries no points, whatever is trusted"


def test_a_line_that_is_right_without_a_student_must_be_marked(imported, capsys):
    folder = imported(checks=(ALWAYS + CHECKS[0], *CHECKS[1:]))
    change(
        folder / "assignment.py", "given=True", "trust=True, points=2"
    )  # another length: Python caches by size
    code, printed = verified(folder, capsys)
    assert code == 1 and "π is more than 3 is ✓ without any student's code: write given=True" in printed
