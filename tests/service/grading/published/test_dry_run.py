"""A published notebook is run before any student has it: what fails, what it takes, what may count."""

from exercises.authoring.importing.importing import read_published
from service.grading.published.dry_run import dry_run
from tests.support.course_shape import CHECKS, SETUP, SOLUTIONS, published, written


def run(tmp_path, sandbox, **cells):
    notebook = read_published(written(tmp_path, "sums.ipynb", published(**cells)), tmp_path / "course", {})
    return notebook, dry_run(notebook, tmp_path, sandbox)


def test_given_cells_run_without_a_student_and_only_lack_their_names(tmp_path, sandbox):
    _, made = run(tmp_path, sandbox)
    assert made.solved is None and made.failures == {} and made.emptied.passed == []
    assert set(made.emptied.costs) == {f"published cell {n}" for n in (1, 3, 5, 7)}
    assert 50 < made.found.peak_mb < 512 and made.found.cpu_s < 5
    assert {line.call.label: float(value) for line, value in made.found.truths.items()} == {
        "twice the sum is 20": 20.0,
        "the series is near π": 3.141592653589793,
    }


def test_what_fails_for_another_reason_is_named_by_its_cell(tmp_path, sandbox):
    _, made = run(
        tmp_path, sandbox, setup=SETUP + "import no_such_package\n", checks=("1 / 0\n", *CHECKS[1:])
    )
    assert "No module named 'no_such_package'" in made.failures["published cell 1"]
    assert "ZeroDivisionError" in made.failures["published cell 3"]
    assert any(one.startswith("published cell 3 fails: ZeroDivision") for one in made.sentences(()))
    assert "published cell 1" in made.text() and "no_such_package" in made.text()


def test_a_line_that_is_right_without_a_student_is_found(tmp_path, sandbox):
    always = 'validate.check(np.pi > 3, "π is more than 3")\n'
    _, made = run(tmp_path, sandbox, checks=(always, *CHECKS[1:]))
    assert [line.call.label for line in made.found.without_student] == ["π is more than 3"]


def test_an_expected_value_that_is_another_one_each_time_is_no_truth(tmp_path, sandbox):
    drawn = 'validate.close(double(total), np.random.normal(), "drawn")\n'
    _, made = run(tmp_path, sandbox, checks=(drawn, *CHECKS[1:]))
    assert [line.call.label for line in made.found.truths] == ["the series is near π"]


def test_the_authors_solutions_run_too(tmp_path, sandbox):
    solved = (SOLUTIONS[0], "powers = [1, 2, 5]\n", SOLUTIONS[2])
    notebook, made = run(tmp_path, sandbox, solutions=solved)
    assert made.solved is not None and made.found.has_solutions and len(made.solved.passed) == 4
    (sentence,) = made.sentences(notebook.taken)
    assert sentence.startswith("published cell 5: with your solutions this line is not ✓: 2 to the power")
    assert made.emptied.passed == []


def test_memory_beyond_that_of_a_submission_is_measured(tmp_path, sandbox):
    _, made = run(tmp_path, sandbox, setup=SETUP + "big = np.ones((80, 1 << 20))\n")
    assert made.failures == {} and made.found.budgets()["memory_mb"] > 1024


def test_a_given_cell_that_never_ends_is_named_and_the_others_run(tmp_path, sandbox, monkeypatch):
    monkeypatch.setattr("service.grading.published.dry_run.CELL_S", 0.5)
    _, made = run(tmp_path, sandbox, checks=("while True:\n    pass\n", *CHECKS[1:]))
    assert "used more than 0.5 s of CPU time" in made.failures["published cell 3"]
    assert [line.call.label for line in made.found.truths] == ["the series is near π"]
