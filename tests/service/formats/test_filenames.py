"""The zip that is sent while it is written is whole, and keeps nothing of what was sent."""

import io
import os
import tracemalloc
import zipfile
from datetime import UTC, datetime
from pathlib import PurePosixPath, PureWindowsPath

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.formats.filenames import MOST_BYTES, UniqueNames, ZipStream, safe_filename

AT = datetime(2026, 2, 28, 23, 59, 58, tzinfo=UTC)


def test_it_is_a_whole_zip_with_names_and_times():
    archive, parts = ZipStream(), []
    for path, content in {"a/é.txt": "x\n" * 5000, "a/b.bin": os.urandom(3000), "a/empty": ""}.items():
        archive.add(path, content, AT)
        parts.append(archive.take())
    assert all(parts)
    with zipfile.ZipFile(io.BytesIO(b"".join([*parts, archive.end()]))) as read:
        assert read.testzip() is None
        assert read.namelist() == ["a/é.txt", "a/b.bin", "a/empty"]
        assert read.read("a/é.txt") == b"x\n" * 5000
        assert read.infolist()[0].date_time == (2026, 2, 28, 23, 59, 58)


def test_it_does_not_hold_what_was_taken():
    archive, content = ZipStream(), os.urandom(1_000_000)
    tracemalloc.start()
    try:
        sent = 0
        for number in range(30):
            archive.add(f"{number}", content, AT)
            sent += len(archive.take())
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert sent > 30_000_000 and most < 6_000_000


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
