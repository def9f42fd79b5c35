"""polhode verify of a declaration: what it prints about samples, the author's notebook,
mistakes and checks.
"""

import pytest

from service.cli.__main__ import main
from service.cli.authoring.verify import made_samples
from service.cli.authoring.verify.command import _select
from tests.support.assignments import change, known
from tests.support.author_notebooks import CELLS, HEIGHT, SPEED, code, declared, write

MODES = """
import numpy as np

from exercises.authoring import Notebook, Value, between, relative

notebook = Notebook("notebook.ipynb")


def exact(a, b):
    angle = np.arctan2(0.6, a - b) / 2
    return [[-np.sin(angle), np.cos(angle)], [np.cos(angle), np.sin(angle)]]


@notebook.exercise("1")
def of_two_masses(ask):
    modes = ask.function("modes")
    modes.case("", a=between(0, 1), b=between(0, 1))
    modes.truth(exact, agree=Value(relative(1e-12, because="rounding"), up_to="column signs"))
    modes.mistake("sign-flipped", "the second stiffness is negative", change="0.3, b -> 0.3, -b")
    exchanged = "[1] -> [1] * [1, -1] @ [[0, 1], [1, 0]]"
    modes.mistake("component-order", "the columns are exchanged", change=exchanged)
    modes.mistake("wrong-function", "the columns are turned", change="[1] -> [1] @ [[0, -1], [1, 0]]")
    modes.mistake("wrong-function", "the second has the other sign", change="[1] -> [1] * [1, -1]")
"""
SOLVED = "def modes(a, b):\n    return np.linalg.eigh([[a, 0.3], [0.3, b]])[1]"


def verify(folder, capsys, *options):
    with known(folder):
        exit_code = main(["verify", "--jobs", "1", "--seeds", "2", str(folder), *options])
    return exit_code, capsys.readouterr().out.splitlines()


@pytest.mark.slow
def test_mistakes_that_the_checks_cannot_tell_apart(tmp_path, capsys, warm_guest):
    exit_code, lines = verify(declared(tmp_path / "modes", MODES, SOLVED), capsys)
    assert exit_code == 1 and lines[:3] == [
        "✓  right_all.py",
        "✓  notebook.ipynb",
        "✓  wrong_1_1_sign_flipped.py",
    ]
    one, other, same = (
        lines.index(f"✗  wrong_1_{name}.py")
        for name in ("2_component_order", "3_wrong_function", "4_wrong_function")
    )
    unnamed = "component-order is not named: another mistake has its numbers, or to try it takes long"
    assert lines[one + 1] == f"     seed 1: {unnamed}"
    for line, equal in ((other - 1, "3_wrong_function"), (same - 1, "2_component_order")):
        assert (
            lines[line]
            == f"     the checks do not distinguish it from wrong_1_{equal}.py (they compare value up to"
            " column signs): give both mistakes the same code and sentence"
        )
    assert (
        lines[same + 1]
        == "     seed 1: every check is ✓: the mistake changes nothing that the checks see (they compare"
        " value up to column signs)"
    )


FULL = [
    *CELLS[:4],
    code(SPEED["source"] + "\ntimes = [1.0, 2.0]", "solution"),
    code("assert speed(times[0], 2.0) == 2.0"),
    HEIGHT,
]


def test_the_authors_notebook_is_graded_and_its_solution_cells_may_set_other_names(
    tmp_path, capsys, warm_guest, monkeypatch
):
    folder = write(tmp_path, FULL)
    monkeypatch.setattr(made_samples, "SLOW_S", 0.0)
    exit_code, lines = verify(folder, capsys)
    assert exit_code == 0 and lines[:4] == [
        "✓  right_all.py",
        "✓  fall.ipynb",
        "✓  wrong_1_1_no_code.py",
        "falling: 3 of 3 samples as expected on 2 seeds, 4 checks",
    ]
    warning, slow = lines[4:]
    assert (
        warning
        == 'warning: no sample fails 2-value and 2-new-value: declare a mistake of height that fails "height'
        ' is right"'
    )
    assert slow.startswith("exercise 1 uses 0.") and slow.endswith(
        " s of CPU time: fewer rows, repetitions or steps make it faster"
    )


@pytest.mark.slow
def test_a_wrong_solution_of_the_authors_notebook_is_reported(tmp_path, capsys, warm_guest):
    wrong = code(HEIGHT["source"].replace("h - g", "h + g"))
    exit_code, lines = verify(write(tmp_path, [*CELLS[:6], wrong]), capsys, "--only", "*.ipynb")
    assert exit_code == 1 and lines[:3] == [
        "✗  fall.ipynb",
        "     seed 1: 2-value is not ✓",
        "     seed 1: 2-new-value is not ✓",
    ]


def test_the_authors_notebook_is_a_sample_of_all_exercises(tmp_path):
    with known(write(tmp_path)) as found:
        made = {sample.name: sample.ask for sample in found.valid["falling"].made_samples()}
    assert made == {"right_all.py": ("1", "2"), "fall.ipynb": ("1", "2"), "wrong_1_1_no_code.py": ("1",)}


@pytest.mark.parametrize("inside", [None, "notes.txt"])
def test_a_known_slug_takes_precedence_over_a_folder_of_that_name(tmp_path, capsys, monkeypatch, inside):
    folder = write(tmp_path, FULL)
    beside = tmp_path / "beside" / "falling"
    beside.mkdir(parents=True)
    if inside:
        (beside / inside).write_text("text")
    monkeypatch.chdir(beside.parent)
    with known(folder):
        selected, invalid = _select(["falling"])
        assert [assignment.folder for assignment in selected] == [folder] and not invalid
    with known():
        assert _select(["falling"])[1] == [
            "no assignment found in falling: name a slug, or a folder that contains assignment.py"
        ]


@pytest.mark.slow
def test_progress_on_a_terminal(tmp_path, capsys, warm_guest, monkeypatch):
    folder = write(tmp_path, FULL)
    change(folder / "assignment.py", "g / 7.25", "g * t + 0 * t")
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    with known(folder):
        main(["verify", "--jobs", "1", "--seeds", "2", str(folder)])
    shown = capsys.readouterr().err
    assert "2 of 9 graded, 2 as expected so far" in shown and "6 of 9 graded, 4 as expected so far" in shown
    assert "8 of 9 graded" in shown


def test_a_pattern_that_no_sample_matches(tmp_path, capsys, warm_guest):
    with known(write(tmp_path, FULL)):
        assert main(["verify", "falling", "--only", "wrong_9*"]) == 2
    assert capsys.readouterr().err == "polhode: falling: no sample to grade\n"


def test_the_source_of_a_sample_is_printed_on_request(tmp_path, capsys):
    folder = write(tmp_path, FULL)
    exit_code, lines = verify(folder, capsys, "--source", "right_all.py")
    assert exit_code == 0 and any(line.startswith("def speed") for line in lines)
    assert verify(folder, capsys, "--source", "nothing.py") == (2, [])


@pytest.mark.parametrize("truth", ["exact(a, b) / 0", "[[1.0]]"])
def test_a_truth_that_fails_is_one_sentence_with_its_line(tmp_path, capsys, truth):
    text = MODES.replace("truth(exact,", f"truth(lambda a, b: {truth},")
    folder = declared(tmp_path / "modes", text, SOLVED)
    with known(folder):
        assert main(["verify", str(folder)]) == 2
    told = capsys.readouterr()
    assert told.out == "" and len(told.err.splitlines()) == 1
    assert told.err.startswith("polhode: assignment modes: assignment.py line ")
