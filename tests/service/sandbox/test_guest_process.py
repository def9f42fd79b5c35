"""The folder of a guest is removed with it, and by the next host if its own was killed."""

import os
import subprocess
import sys
import time

import pytest

from service.sandbox import guest_process
from service.sandbox.guest_process import PREFIX, GuestProcess, remove_abandoned

HOST = """
import pathlib, sys, time
from service.sandbox import guest_process
guest_process._temporary_folder = lambda: pathlib.Path(sys.argv[1])
guest = guest_process.GuestProcess(["sleep", "60"], {})
scratch = guest.data.parent / "scratch"
(scratch / "a" / "b").mkdir(parents=True)
(scratch / "a" / "b" / "left.txt").write_text("a student's")
(scratch / "link").symlink_to(sys.argv[2])
print(guest.process.pid, flush=True)
time.sleep(60)
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The folder for temporary files."""
    made = tmp_path / "temporary"
    made.mkdir()
    monkeypatch.setattr(guest_process, "_temporary_folder", lambda: made)
    monkeypatch.setattr(guest_process, "NEW_S", 0.0)
    return made


def test_a_guest_that_is_killed_leaves_nothing(folder):
    guest = GuestProcess(["sleep", "60"], {})
    (guest.data.parent / "scratch" / "left.txt").write_text("a student's")
    remove_abandoned()
    assert guest.data.is_dir(), "its host lives"
    guest.kill()
    assert list(folder.iterdir()) == []


def test_what_a_killed_host_left_is_removed_by_the_next(folder, tmp_path, monkeypatch):
    kept = tmp_path / "kept"
    kept.mkdir()
    (kept / "of another").write_text("kept")
    host = subprocess.Popen([sys.executable, "-c", HOST, folder, kept], stdout=subprocess.PIPE)
    assert host.stdout is not None
    with host.stdout as said:
        guest = int(said.readline())
    try:
        (left,) = folder.glob(f"{PREFIX}*")
        remove_abandoned()
        assert (left / "scratch" / "a" / "b" / "left.txt").exists()
        host.kill()
        host.wait()
    finally:
        os.kill(guest, 9)
    monkeypatch.setattr(guest_process, "NEW_S", 60.0)
    remove_abandoned()
    assert left.is_dir(), "it may be one that is made now"
    monkeypatch.setattr(guest_process, "NEW_S", 0.0)
    time.sleep(0.01)
    (folder / "another's").mkdir()
    (folder / f"{PREFIX}link").symlink_to(kept)
    remove_abandoned()
    assert {one.name for one in folder.iterdir()} == {"another's", f"{PREFIX}link"}
    assert (kept / "of another").read_text() == "kept"
