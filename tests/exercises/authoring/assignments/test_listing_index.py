"""An assignment with an index is listed without being loaded, and loaded when more of it is read."""

import json
import shutil

import pytest

from exercises.authoring.assignments import catalogue
from exercises.authoring.assignments.assignment import InvalidAssignment
from exercises.authoring.assignments.listing_index import COUNTED, INDEX, SHOWN, IndexedAssignment, read_index
from service.cli.__main__ import main
from tests.support.assignments import change, known
from tests.support.course_shape import published, written


@pytest.fixture
def folder(tmp_path):
    file = written(tmp_path, "small-sums.ipynb", published())
    with known():
        assert main(["import-notebook", str(file), "--into", str(tmp_path / "into")]) == 0
    return tmp_path / "into" / "small_sums"


def test_lists_need_no_loading(folder, monkeypatch):
    monkeypatch.setattr(catalogue, "load", lambda folder: 1 / 0)
    with known(folder) as found:
        one = found.valid["small-sums"]
        assert isinstance(one, IndexedAssignment)
        assert (one.slug, one.title, one.version) == ("small-sums", "9.9 Small sums", "1")
        assert one.most_points == one.max_points() == 0 and one.folder == folder
        assert one.points_note == "5 of 5 checks carry no points"


def test_what_the_index_does_not_have_is_loaded(folder):
    with known(folder) as found:
        one, loaded = found.valid["small-sums"], catalogue.find("small-sums")
        assert [e.number for e in one.exercises] == ["1", "2", "3"]
        assert one.published == loaded.published and one.load_s == 60.0
        assert one.max_points(["1"]) == 0


@pytest.mark.parametrize("folder", catalogue.folders(), ids=lambda folder: folder.name)
def test_lists_of_the_bundled_assignments_say_what_these_say(folder):
    loaded, index = catalogue.find(folder.name), read_index(folder)
    assert index is not None and index.keys() == {*SHOWN, *COUNTED, "files"}
    listed = IndexedAssignment(folder, index, (), lambda: 1 / 0)
    assert listed.slug == loaded.slug and listed.max_points() == loaded.max_points()
    assert [getattr(listed, name) for name in SHOWN] == [getattr(loaded, name) for name in SHOWN]


def test_an_assignment_in_a_folder_that_cannot_be_written_is_loaded(folder):
    shutil.rmtree((folder / INDEX).parent)
    (folder / INDEX).parent.write_text("")
    for _ in range(2):
        with known(folder) as found:
            assert found.valid["small-sums"].title == "9.9 Small sums"
            assert not isinstance(found.valid["small-sums"], IndexedAssignment)


def test_another_text_makes_the_index_invalid(folder):
    change(folder / "assignment.py", "shown=True)", "shown=True, accept=True)")
    with known(folder) as found:
        assert not isinstance(found.valid["small-sums"], IndexedAssignment)
        assert found.valid["small-sums"].max_points() == 2
    with known(folder) as found:
        assert isinstance(found.valid["small-sums"], IndexedAssignment)
        assert found.valid["small-sums"].most_points == 2


@pytest.mark.parametrize("text", ["", "{", "[]", '{"files": 1}'])
def test_a_broken_index_counts_for_nothing(folder, text):
    (folder / INDEX).write_text(text)
    with known(folder) as found:
        assert found.valid["small-sums"].title == "9.9 Small sums"
        assert not isinstance(found.valid["small-sums"], IndexedAssignment)


def test_an_error_in_the_file_is_seen_at_once(folder):
    index = json.loads((folder / INDEX).read_text())
    change(folder / "assignment.py", "notebook = Notebook(", "notebook = Notebok(")
    with known(folder) as found:
        assert "small-sums" in found.invalid and index["title"] == "9.9 Small sums"


def test_another_data_file_makes_the_index_invalid(folder):
    (folder / "track.csv").write_text("1,2\n")
    with known(folder) as found:
        assert not isinstance(found.valid["small-sums"], IndexedAssignment)


def test_a_hidden_file_changes_nothing(folder):
    (folder / ".DS_Store").write_bytes(b"x")
    with known(folder) as found:
        assert isinstance(found.valid["small-sums"], IndexedAssignment)


def test_one_that_no_longer_loads_is_invalid(folder, monkeypatch):
    """As after the update of a package that it imports: its files, and so its index, are unchanged."""
    monkeypatch.setattr(catalogue, "load", lambda folder: (None, ["it needs another package"]))
    with known(folder) as found:
        one = found.valid["small-sums"]
        with pytest.raises(InvalidAssignment, match="small-sums: it needs another package"):
            catalogue.find("small-sums")
        with pytest.raises(InvalidAssignment):
            list(one.exercises)
