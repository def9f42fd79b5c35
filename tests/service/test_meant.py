"""Which assignment files are graded by where nobody says so: one that is certain, or none."""

import pytest

from exercises.assignment import InvalidAssignment, NoAssignment
from service.cli import main
from service.meant import meant
from tests.support.assignments import change, copied, known


@pytest.fixture
def file(tmp_path):
    def write(source, name="mine.py"):
        (tmp_path / name).write_text(source)
        return tmp_path / name

    return write


def test_the_only_one_there_is(file):
    with known():
        assert meant(None, [file("x = 1")]).slug == "rigid-body"


def test_one_of_several_is_told_by_the_functions_or_by_the_folder(file, tmp_path):
    folder = copied(tmp_path / "course")
    with known(folder):
        assert meant(None, [file("def euler_eqs(t, w, I): ...")]).slug == "rigid-body"
        assert (
            meant(None, [file('{"source": ["oscillator = lambda t, y, omega, gamma: y"]}', "a.ipynb")]).slug == "damped-oscillator"
        )
        assert meant(None, [file("euler_eqs = 1"), file("x = 1", "b.py")]).slug == "rigid-body"
        assert meant(None, [folder / "specimens" / "right_terms.py"]).slug == "damped-oscillator"
        assert meant("rigid_body", [folder / "specimens" / "right_terms.py"]).slug == "rigid-body"


def test_nothing_is_guessed(file, tmp_path):
    course = tmp_path / "course"
    copied(course)
    with known(course):
        for source in ("x = 1", "oscillator = euler_eqs = None"):
            with pytest.raises(NoAssignment, match="Say --assignment damped-oscillator or rigid-body"):
                meant(None, [file(source)])
    copied(course, "same_functions")
    with known(course), pytest.raises(NoAssignment, match="damped-oscillator or rigid-body or same-functions"):
        meant(None, [file("def oscillator(): ...")])


def test_where_one_is_broken_its_files_are_graded_by_no_other(file, tmp_path, capsys):
    """It may ask for the same function: by the other one's checks a right answer would be wrong."""
    course = tmp_path / "course"
    copied(course)
    folder = copied(course, "broken_one")
    change(folder / "secret.py", "limit=1e-13", 'limit=1e-13, hidden="yes"')
    with known(course):
        with pytest.raises(InvalidAssignment, match=r"secret\.py line 9: TypeError"):
            meant(None, [folder / "specimens" / "right_terms.py"])
        with pytest.raises(NoAssignment, match="assignment broken-one"):
            meant(None, [file("def oscillator(): ...")])
        assert main(["grade", "--assignment", "broken-one", str(file("def oscillator(): ..."))]) == 2
        assert "polhode: assignment broken-one: secret.py line 9" in capsys.readouterr().err
        assert main(["assignments"]) == 2
        told = capsys.readouterr()
        assert "damped-oscillator  The damped oscillator" in told.out and "polhode: assignment broken-one" in told.err
        assert main(["grade", "--assignment", "damped-oscillator", str(folder / "specimens" / "right_terms.py")]) == 0
