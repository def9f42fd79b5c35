import os

import pytest

from service.cli.grading.find_files import NoSubmissionFound, find_files
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
