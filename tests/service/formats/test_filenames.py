"""Safe file names are parts of a path everywhere, and different in a folder."""

from pathlib import PurePosixPath, PureWindowsPath

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.formats.filenames import MOST_BYTES, UniqueNames, safe_filename

EVIL = {
    "../../etc/passwd": "etc_passwd",
    "..\\..\\boot.ini": "boot.ini",
    "/root/.ssh/id": "root.ssh_id",
    "C:\\x.py": "C_x.py",
    "..": "file",
    ".": "file",
    "": "file",
    "a\x00b\n.py": "a_b.py",
    "con": "_con",
    "NUL.py": "_NUL.py",
    "-rf": "rf",
    "mine.py. ": "mine.py",
    "a\u202eyp.exe": "a_yp.exe",
    "Çelik Åsa": "Çelik_Åsa",
    "=cmd|x": "cmd_x",
    "x" * 300 + ".ipynb": "x" * 74 + ".ipynb",
}


@pytest.mark.parametrize(("text", "name"), EVIL.items())
def test_the_corpus(text, name):
    assert safe_filename(text) == name


@given(st.text(max_size=200))
def test_any_text_gives_one_part_of_a_path(text):
    name = safe_filename(text)
    assert PurePosixPath(name).parts == PureWindowsPath(name).parts == (name,) and name not in (".", "..")
    assert (
        len(name.encode()) <= MOST_BYTES + 1
        and name.isprintable()
        and name == name.strip()
        and not name.startswith((".", "-"))
    )
    assert not PureWindowsPath(name).drive


@given(
    st.lists(
        st.sampled_from(
            ["Ann", "ann", "a/b", "a_b", "a?b", "ANN-2", "ann-2", "ﬁ", "fi", "Å", "A\u030a", "x.py", "X.PY"]
        ),
        max_size=12,
    )
)
def test_no_two_names_of_a_folder_are_one(texts):
    names = UniqueNames(["report.json"])
    given = [names.give(text).casefold() for text in [*texts, "Report.json"]]
    assert len(set(given)) == len(given) and "report.json" not in given
