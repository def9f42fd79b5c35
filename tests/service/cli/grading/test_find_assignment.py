import json

import pytest

from exercises.authoring.assignments.assignment import InvalidAssignment, NoAssignment
from service.cli.__main__ import main
from service.cli.grading.find_assignment import find_assignment
from tests.support.assignments import change, copied, known


@pytest.fixture
def file(tmp_path):
    def write(source, name="mine.py"):
        (tmp_path / name).write_text(source)
        return tmp_path / name

    return write


def test_the_only_one_there_is(file):
    with known():
        assert find_assignment(None, [file("x = 1")]).slug == "rigid-body"


def test_one_of_several_is_told_by_the_functions_or_by_the_folder(file, tmp_path):
    folder = copied(tmp_path / "course")
    with known(folder):
        assert find_assignment(None, [file("def euler_eqs(t, w, I): ...")]).slug == "rigid-body"
        assert (
            find_assignment(
                None, [file('{"source": ["oscillator = lambda t, y, omega, gamma: y"]}', "a.ipynb")]
            ).slug
            == "damped-oscillator"
        )
        assert (
            find_assignment(None, [file('{"source": "import os\\ndef euler_eqs(): ..."}', "b.ipynb")]).slug
            == "rigid-body"
        )
        assert find_assignment(None, [file("euler_eqs = 1"), file("x = 1", "b.py")]).slug == "rigid-body"
        assert find_assignment(None, [folder / "samples" / "right_terms.py"]).slug == "damped-oscillator"
        assert find_assignment("rigid_body", [folder / "samples" / "right_terms.py"]).slug == "rigid-body"


def test_the_functions_that_a_file_defines_take_precedence_over_those_that_it_names(file, tmp_path):
    copied(tmp_path / "course")
    with known(tmp_path / "course"):
        assert (
            find_assignment(None, [file("def euler_eqs(t, w, I): ...\nfrom mine import oscillator")]).slug
            == "rigid-body"
        )
        assert find_assignment(None, [file("from mine import oscillator")]).slug == "damped-oscillator"


def test_a_function_inside_another_one_determines_nothing(file, tmp_path):
    copied(tmp_path / "course")
    inside = "def euler_eqs(t, w, I):\n    def oscillator(): ..."
    with known(tmp_path / "course"):
        assert find_assignment(None, [file(inside)]).slug == "rigid-body"
        cell = json.dumps({"source": inside.splitlines(keepends=True)}, indent=1)
        assert find_assignment(None, [file(cell, "a.ipynb")]).slug == "rigid-body"


def test_nothing_is_guessed(file, tmp_path):
    course = tmp_path / "course"
    copied(course)
    with known(course):
        for source in ("x = 1", "oscillator = euler_eqs = None"):
            with pytest.raises(NoAssignment, match="give --assignment damped-oscillator or rigid-body"):
                find_assignment(None, [file(source)])
    copied(course, "same_functions")
    with (
        known(course),
        pytest.raises(NoAssignment, match="damped-oscillator or rigid-body or same-functions"),
    ):
        find_assignment(None, [file("def oscillator(): ...")])


@pytest.mark.slow
def test_where_one_is_broken_its_files_are_graded_by_no_other(file, tmp_path, capsys):
    """It may ask for the same function: by the other one's checks a right answer would be wrong."""
    course = tmp_path / "course"
    copied(course)
    folder = copied(course, "broken_one")
    change(folder / "assignment.py", "until=20.0", 'until=20.0, hidden="yes"')
    with known(course):
        with pytest.raises(InvalidAssignment, match="line 21: right_hand_side has no argument hidden"):
            find_assignment(None, [folder / "samples" / "right_terms.py"])
        with pytest.raises(NoAssignment, match="assignment broken-one"):
            find_assignment(None, [file("def oscillator(): ...")])
        assert main(["grade", "--assignment", "broken-one", str(file("def oscillator(): ..."))]) == 2
        assert "polhode: assignment broken-one: assignment.py line 21" in capsys.readouterr().err
        assert main(["assignments"]) == 2
        told = capsys.readouterr()
        assert (
            "damped-oscillator  The damped oscillator" in told.out
            and "polhode: assignment broken-one" in told.err
        )
        assert (
            main(["grade", "--assignment", "damped-oscillator", str(folder / "samples" / "right_terms.py")])
            == 0
        )
