import json
import os

import pytest

from exercises.authoring.assignments.assignment import InvalidAssignment, NoAssignment
from service.cli.__main__ import main
from service.cli.files import NoSubmissionFound, find_files, resolve_assignment
from tests.support.assignments import change, copied, known
from tests.support.command_line import polhode


@pytest.fixture
def tree(tmp_path, monkeypatch):
    for name in (
        "b.py",
        "a.ipynb",
        "notes.txt",
        "deep/er/c.py",
        ".ipynb_checkpoints/a.ipynb",
        "deep/__pycache__/c.py",
        ".hidden.py",
    ):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("x = 1")
    (tmp_path / "empty").mkdir()
    (tmp_path / "loop").symlink_to(tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_folder_gives_what_is_in_it_and_below_but_nothing_hidden(tree):
    assert [str(f.relative_to(tree)) for f in find_files([str(tree)])] == ["a.ipynb", "b.py", "deep/er/c.py"]


@pytest.mark.parametrize(
    ("named", "found"),
    [
        (["b.py", "a.ipynb"], ["b.py", "a.ipynb"]),
        (["deep", "b.py", "deep/er/../er/c.py"], ["deep/er/c.py", "b.py"]),
        (["*.*"], ["a.ipynb", "b.py"]),
        (["**/c.py"], ["deep/er/c.py"]),
        (["d*p"], ["deep/er/c.py"]),
    ],
)
def test_files_folders_and_patterns(tree, named, found):
    assert list(map(str, find_files(named))) == found


@pytest.mark.parametrize("name", ["nowhere.py", "empty", "*.rs", "b.py/x"])
def test_a_name_that_leads_nowhere(tree, name):
    with pytest.raises(NoSubmissionFound, match=r"no such file|no \.py or \.ipynb"):
        find_files(["b.py", name])


def test_a_named_file_that_cannot_be_a_submission(tree):
    (tree / "README.md").write_text("# euler_eqs")
    with pytest.raises(
        NoSubmissionFound,
        match=r"README\.md: cannot be a submission: name a \.py, \.ipynb or \.json file; if it holds Python, "
        r"rename it to end in \.py",
    ):
        find_files(["b.py", "README.md"])
    told = polhode("grade", "b.py", "README.md", "--assignment", "rigid-body")
    assert told.returncode == 2 and "README.md: cannot be a submission" in told.stderr and not told.stdout


def test_a_name_with_the_characters_of_a_pattern(tree):
    (tree / "x[1].py").write_text("x = 1")
    assert list(map(str, find_files(["x[1].py"]))) == ["x[1].py"]


def test_an_ending_in_large_letters_is_not_passed_over(tree):
    (tree / "deep" / "Zed.PY").write_text("x = 1")
    assert tree / "deep" / "Zed.PY" in find_files([str(tree)])


def test_a_pattern_below_a_hidden_folder(tree):
    (tree / ".class").mkdir()
    (tree / ".class" / "d.py").write_text("x = 1")
    assert find_files([str(tree / ".class" / "*.py")]) == [tree / ".class" / "d.py"]


def test_a_link_in_a_folder_takes_nobodys_file(tree):
    (tree / "ann").mkdir()
    (tree / "ann" / "mine.py").symlink_to(tree / "deep" / "er" / "c.py")
    (tree / "all").symlink_to(tree / "deep")
    for named in (".", "*", "*/", "**/*.py", f"{tree}/*/"):
        assert [f.name for f in find_files([named]) if f.suffix == ".py"].count("c.py") == 1, named
        assert tree / "deep/er/c.py" in [tree / f for f in find_files([named])], named
    assert list(map(str, find_files(["ann/mine.py"]))) == ["ann/mine.py"]


def test_a_folder_that_cannot_be_listed_is_not_passed_over(tree, monkeypatch):
    def scandir(path, real=os.scandir):
        if str(path).endswith("er"):
            raise PermissionError(13, "Permission denied", str(path))
        return real(path)

    monkeypatch.setattr(os, "scandir", scandir)
    with pytest.raises(PermissionError, match="deep/er"):
        find_files(["."])


@pytest.fixture
def file(tmp_path):
    def write(source, name="mine.py"):
        (tmp_path / name).write_text(source)
        return tmp_path / name

    return write


def test_the_only_one_there_is(file):
    with known():
        assert resolve_assignment(None, [file("x = 1")]).slug == "rigid-body"


def test_one_of_several_is_told_by_the_functions_or_by_the_folder(file, tmp_path):
    folder = copied(tmp_path / "course")
    with known(folder):
        assert resolve_assignment(None, [file("def euler_eqs(t, w, I): ...")]).slug == "rigid-body"
        assert (
            resolve_assignment(
                None, [file('{"source": ["oscillator = lambda t, y, omega, gamma: y"]}', "a.ipynb")]
            ).slug
            == "damped-oscillator"
        )
        assert (
            resolve_assignment(None, [file('{"source": "import os\\ndef euler_eqs(): ..."}', "b.ipynb")]).slug
            == "rigid-body"
        )
        assert resolve_assignment(None, [file("euler_eqs = 1"), file("x = 1", "b.py")]).slug == "rigid-body"
        assert resolve_assignment(None, [folder / "samples" / "right_terms.py"]).slug == "damped-oscillator"
        assert resolve_assignment("rigid_body", [folder / "samples" / "right_terms.py"]).slug == "rigid-body"


def test_the_functions_that_a_file_defines_take_precedence_over_those_that_it_names(file, tmp_path):
    copied(tmp_path / "course")
    with known(tmp_path / "course"):
        assert (
            resolve_assignment(None, [file("def euler_eqs(t, w, I): ...\nfrom mine import oscillator")]).slug
            == "rigid-body"
        )
        assert resolve_assignment(None, [file("from mine import oscillator")]).slug == "damped-oscillator"


def test_a_function_inside_another_one_determines_nothing(file, tmp_path):
    copied(tmp_path / "course")
    inside = "def euler_eqs(t, w, I):\n    def oscillator(): ..."
    with known(tmp_path / "course"):
        assert resolve_assignment(None, [file(inside)]).slug == "rigid-body"
        cell = json.dumps({"source": inside.splitlines(keepends=True)}, indent=1)
        assert resolve_assignment(None, [file(cell, "a.ipynb")]).slug == "rigid-body"


def test_nothing_is_guessed(file, tmp_path):
    course = tmp_path / "course"
    copied(course)
    with known(course):
        for source in ("x = 1", "oscillator = euler_eqs = None"):
            with pytest.raises(NoAssignment, match="give --assignment damped-oscillator or rigid-body"):
                resolve_assignment(None, [file(source)])
    copied(course, "same_functions")
    with (
        known(course),
        pytest.raises(NoAssignment, match="damped-oscillator or rigid-body or same-functions"),
    ):
        resolve_assignment(None, [file("def oscillator(): ...")])


@pytest.mark.slow
def test_where_one_is_broken_its_files_are_graded_by_no_other(file, tmp_path, capsys):
    """It may ask for the same function: by the other one's checks a right answer would be wrong."""
    course = tmp_path / "course"
    copied(course)
    folder = copied(course, "broken_one")
    change(folder / "assignment.py", "until=20.0", 'until=20.0, hidden="yes"')
    with known(course):
        with pytest.raises(InvalidAssignment, match="line 22: right_hand_side has no argument hidden"):
            resolve_assignment(None, [folder / "samples" / "right_terms.py"])
        with pytest.raises(NoAssignment, match="assignment broken-one"):
            resolve_assignment(None, [file("def oscillator(): ...")])
        assert main(["grade", "--assignment", "broken-one", str(file("def oscillator(): ..."))]) == 2
        assert "polhode: assignment broken-one: assignment.py line 22" in capsys.readouterr().err
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
