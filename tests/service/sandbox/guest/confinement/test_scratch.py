"""The scratch folder of a child: what works in it, what it may hold, and that nothing of it is left."""

import os
import select
import signal
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest

from exercises.authoring.assignments.assignment import ArraySpec
from polhode.judging.outcome import Ended
from service.sandbox.guest import zygote
from service.sandbox.guest.confinement import scratch
from service.sandbox.guest.confinement.scratch import MIB, NO_ROOM, Scratch, remove
from service.sandbox.isolation.levels import process_isolation
from service.sandbox.job import Cell, Job, SceneRequest
from service.sandbox.sandbox import Sandbox

SETUP = "import numpy as np"
PLAYS = "def ask(student, inputs):\n    return {'x': student['np'].array(student['f'](1.0))}"
ASKED = SceneRequest("one", "ask", "f", {}, {"x": ArraySpec((2,))}, 5.0, None)
RIGHT = "def f(x):\n    return [x, x]"


def job(*cells, **fields):
    """A job with these cells of a notebook, and a last one with a right function."""
    named = tuple(Cell(f"cell {number}", source) for number, source in enumerate((*cells, RIGHT), start=1))
    return Job(SETUP, PLAYS, named, ("f",), (ASKED,), **fields)


def played(sandbox, *cells, **fields):
    """Play a job whose function has to be right, whatever the cells do."""
    result = sandbox.play(job(*cells, **fields))
    assert result.finished("one"), result
    return result


WORKS = {
    "folders": 'import os\nos.makedirs("a/b/c")\nos.rename("a/b/c", "c")\nos.removedirs("a/b")',
    "text": 'with open("x.txt", "w") as f:\n    f.write("5")\nassert open("x.txt").read() == "5"',
    "length": 'f = open("x", "ab+")\nf.write(bytes(9))\nassert f.truncate(4) == 4\nf.close()',
    "pathlib": (
        "from pathlib import Path\nPath('a').mkdir()\nPath('a/b').write_text('x')\nPath('a/b').rename('c')\n"
        "Path('c').touch()\nPath('d').touch()\nPath('c').unlink()\nassert not Path('c').exists()"
    ),
    "synchronized": "import os\nf = open('x', 'w')\nos.fsync(f.fileno())\nos.fdatasync(f.fileno())",
    "numpy": (
        "np.savetxt('t.csv', np.arange(4.0))\nnp.save('a', np.arange(4.0))\nnp.savez('z', a=np.arange(4.0))\n"
        "assert np.load('a.npy', mmap_mode='r+')[3] == np.loadtxt('t.csv')[3] == np.load('z.npz')['a'][3]"
    ),
    "map": (
        "m = np.memmap('m', dtype=float, mode='w+', shape=9)\nm[:] = 2\nm.flush()\ndel m\n"
        "assert np.fromfile('m').sum() == 18"
    ),
    "figures": (
        "import matplotlib.pyplot as plt\nplt.plot([1, 2])\n"
        "for name in ('f.png', 'f.pdf', 'f.svg'):\n    plt.savefig(name)\nassert plt.imread('f.png').any()"
    ),
    "animation": (
        "import matplotlib.pyplot as plt\nfrom matplotlib.animation import FuncAnimation\n"
        "FuncAnimation(plt.figure(), lambda k: [], frames=3).save('film.mp4')"
    ),
    "tempfile": (
        "import os, tempfile\nwith tempfile.TemporaryDirectory() as d:\n    open(f'{d}/x', 'w').close()\n"
        "with tempfile.NamedTemporaryFile() as f:\n    assert f.name.startswith(os.getcwd())\n"
        "with tempfile.TemporaryFile() as f:\n    f.write(b'x')\n"
        "os.close(tempfile.mkstemp()[0])"
    ),
    "copies": (
        "import os, shutil\nos.makedirs('a/b')\nopen('a/b/x', 'w').close()\nshutil.copy('a/b/x', 'y')\n"
        "shutil.copy2('y', 'z')\nshutil.copytree('a', 'c')\nshutil.move('z', 'c/b')\nshutil.rmtree('a')\n"
        "os.chmod('y', 0o600)\nos.utime('y')"
    ),
    "archives": (
        "import shutil, tarfile, zipfile\nopen('x', 'w').close()\n"
        "zipfile.ZipFile('x.zip', 'w').write('x')\ntarfile.open('x.tgz', 'w:gz').add('x')\n"
        "shutil.unpack_archive('x.zip', 'out')"
    ),
    "logging": "import logging\nlogging.basicConfig(filename='log', force=True)\nlogging.warning('x')",
    "who and where": (
        "import getpass, os, pathlib\nassert getpass.getuser()\n"
        "assert os.path.expanduser('~') == str(pathlib.Path.home()) == os.getcwd()"
    ),
    "working folder": (
        "import os\nhome = os.getcwd()\nos.mkdir('in')\nos.chdir('in')\nopen('x', 'w').close()\n"
        "os.chdir('..')\n"
        "assert os.path.exists('in/x') and os.getcwd() == home"
    ),
    "magics": (
        "import os\nos.mkdir('in')\n%cd in\nopen('x', 'w').close()\n%cd ..\n%cd -q in\n%cd ~\n"
        "%pushd in\n%popd\n"
        "assert os.listdir() == ['in']"
    ),
}


@pytest.mark.parametrize("source", WORKS.values(), ids=WORKS)
def test_what_notebooks_do_with_files_works(either_sandbox, source):
    assert not played(either_sandbox, source).cells


def test_a_module_that_a_cell_writes_can_be_imported_at_once(either_sandbox):
    """Also if the folder was looked through a moment before, and in a file of Python."""
    cells = [
        source
        for number in range(9)
        for source in (f"%%writefile own{number}.py\nvalue = {number}\n", f"import own{number}")
    ]
    result = played(either_sandbox, *cells, "print(own0.value + own4.value + own8.value)")
    assert not result.cells and result.stdout.endswith("Writing own8.py\n12\n")
    script = "for k in range(9):\n    open(f'q{k}.py', 'w').close()\n    __import__(f'q{k}')\n"
    result = either_sandbox.play(replace(job(), cells=(Cell("mine.py", script + RIGHT),)))
    assert result.finished("one") and not result.cells


def test_the_folder_is_new_for_every_child(either_sandbox):
    source = (
        "import os\nprint(os.listdir(), os.stat('.').st_size)\nfor k in range(300):\n    os.mkdir(f'left{k}')"
    )
    first, second = (played(either_sandbox, source).stdout for _ in range(2))
    assert first == second and first.startswith("[]")


FILLS = {
    "bytes": "for k in range(9):\n    open(f'x{k}', 'wb').write(bytes(8 << 20))",
    "number": "for k in range(1500):\n    open(f'x{k}', 'w').close()",
    "folders": "import os\nfor k in range(1500):\n    os.mkdir(f'x{k}')",
}


@pytest.mark.parametrize("source", FILLS.values(), ids=FILLS)
def test_a_statement_that_fills_it_is_left_out_and_named(either_sandbox, source):
    """However fast it is: the definitions after it are not blamed."""
    result = played(either_sandbox, "a = 1", f"b = 2\n{source}\nc = 3", "print(a + b + c)")
    (end,) = result.cells.values()
    assert end.scene == "cell 2" and NO_ROOM in end.sentence and "32 MiB and 1000 files" in end.sentence
    if result.left_out:  # at the level namespaces the write fails instead when there is no room
        ((place, _),) = result.left_out.items()
        assert (place.cell, place.line) == ("cell 2", source.count("import os") + 2)
        assert end.ended is Ended.OUTPUT and result.stdout == "6\n"
    else:
        assert end.ended is Ended.RAISED and end.sentence.endswith("No space left on device)")


def test_a_function_that_fills_it_ends_its_scene(either_sandbox):
    source = "def f(x):\n    for k in range(5000):\n        open(f'y{k}', 'w').close()\n    while True: pass"
    result = either_sandbox.play(replace(job(), cells=(Cell("mine.py", source),)))
    end = result.scene_ends["one"]
    assert (end.ended, end.sentence) == (Ended.OUTPUT, NO_ROOM)
    assert played(either_sandbox).finished("one")


def test_one_file_has_a_limit_which_the_sentence_names(either_sandbox):
    source = "f = open('x', 'wb', 0)\nfor k in range(20):\n    f.write(bytes(1 << 20))\n"
    (end,) = played(either_sandbox, source).cells.values()
    assert end.ended is Ended.RAISED and end.sentence.startswith(NO_ROOM) and "16 MiB" in end.sentence


def test_a_file_elsewhere_is_refused_with_a_sentence(either_sandbox):
    (end,) = played(either_sandbox, "open('/dev/urandom', 'w')").cells.values()
    assert "only in the working folder" in end.sentence and "Permission denied" in end.sentence


def test_a_child_sees_neither_folders_of_others_nor_their_names(either_sandbox):
    for way in ("..", "../..", "/proc/self/cwd/.."):
        (end,) = played(either_sandbox, f"import os\nprint(os.listdir({way!r}))").cells.values()
        assert "PermissionError" in end.sentence or "FileNotFoundError" in end.sentence


@pytest.fixture
def data(tmp_path):
    """Data files by their names: two small ones, and some that are too large together."""
    files = {"points.csv": b"1,2\n3,4\n", "runs/first.csv": b"5\n"}
    files |= {f"zz{number}.bin": bytes(3 * MIB) for number in range(4)}
    for name, content in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(content)
    return {name: tmp_path / name for name in files}


def test_data_files_can_be_read_and_overwritten_for_this_child_only(either_sandbox, data):
    source = (
        "import os\n"
        "total = np.loadtxt('points.csv', delimiter=',').sum()\n"
        "size = sum(len(open(f'zz{k}.bin', 'rb').read()) for k in range(4)) >> 20\n"
        "print(total, open('runs/first.csv').read().strip(), size, sorted(os.listdir()))\n"
        "np.savetxt('points.csv', [[9]])\nos.remove('runs/first.csv')\nos.rmdir('runs')\n"
        "open('zz0.bin', 'w').write('other')\nos.remove('zz3.bin')\nopen('zz3.bin', 'w').write('mine')"
    )
    told = [played(either_sandbox, source, data=data) for _ in range(2)]
    assert told[0].stdout == told[1].stdout and not told[0].cells
    assert told[0].stdout.startswith("10.0 5 12 ['points.csv', 'runs', 'zz0.bin'")
    (end,) = played(either_sandbox, "open('zz3.bin', 'w')", data=data).cells.values()
    assert end.ended is Ended.RAISED, "a large one is not copied"
    assert played(either_sandbox, "import os\nprint(os.listdir())").stdout == "[]\n"
    full = "for k in range(3):\n    open(f'x{k}', 'wb').write(bytes(10 << 20))\n"
    assert not played(either_sandbox, full, data=data).cells, "they do not count"


def test_a_zygote_that_cannot_remove_a_folder_is_replaced():
    """Nothing that a child can do prevents that. Here root does."""
    if os.geteuid() != 0:
        pytest.skip("only root can make a folder that the guest cannot remove")
    one = Sandbox(process_isolation())
    try:
        one.wait_ready()
        room = one.start()._started.data.parent / "scratch"
        replaced = one.replaced

        def keep_a_file():
            (folder,) = _until(lambda: [*room.iterdir()])
            (folder / "kept").mkdir()
            (folder / "kept" / "file").touch()

        with ThreadPoolExecutor(1) as executor:
            kept = executor.submit(keep_a_file)
            played(one, "import time\ntime.sleep(0.5)")
            kept.result()
        assert played(one, "import os\nprint(os.listdir())").stdout == "[]\n" and one.replaced == replaced + 1
    finally:
        one.close()
    assert not room.parent.exists()


def test_the_folder_of_a_guest_is_removed_with_all_that_is_in_it():
    one = Sandbox(process_isolation())
    one.wait_ready()
    folder = one.start()._started.data.parent
    played(
        one, "import os\nfor k in range(50):\n    os.makedirs(f'a{k}/b/c')\n    open(f'a{k}/x', 'w').close()"
    )
    one.close()
    assert not folder.exists()


def test_a_folder_is_removed_whatever_is_in_it(tmp_path):
    """Nested deeper than a path can be long, closed to its owner, with links out of it."""
    outside, folder = tmp_path / "outside", tmp_path / "room" / "folder"
    folder.mkdir(parents=True)
    outside.mkdir()
    (outside / "kept").write_text("kept")
    (folder / "link").symlink_to(outside)
    (folder / "to a file").symlink_to(outside / "kept")
    os.mkfifo(folder / "fifo")
    at = os.open(folder, os.O_RDONLY)
    for _ in range(3000):
        os.mkdir("d" * 100, dir_fd=at)
        below = os.open("d" * 100, os.O_RDONLY, dir_fd=at)
        os.close(at)
        at = below
    os.close(os.open(b"\xff\n", os.O_CREAT, dir_fd=at))
    os.close(at)
    for mode in (0, 0o100, 0o300, 0o500):
        closed = folder / f"closed {mode}"
        (closed / "inner").mkdir(parents=True)
        (closed / "inner" / "file").touch(0)
        (closed / "inner").chmod(mode)
        closed.chmod(mode)
    remove(str(folder))
    assert [*folder.parent.iterdir()] == [] and (outside / "kept").read_text() == "kept"


def test_what_counts(tmp_path):
    def one():
        return Scratch(str(tmp_path))

    empty = one()
    empty.fill(str(Path(empty.path)))
    assert not empty.is_full()
    for number in range(scratch.MOST_ENTRIES):
        Path(empty.path, f"{number}").touch()
    assert not empty.is_full()
    Path(empty.path, "one more").mkdir()
    assert empty.is_full()
    deep = one()
    os.makedirs(os.path.join(deep.path, *"d" * scratch.MOST_DEPTH))
    assert not deep.is_full()
    os.makedirs(os.path.join(deep.path, *"d" * (scratch.MOST_DEPTH + 1)))
    assert deep.is_full()
    linked = one()
    Path(linked.path, "link").symlink_to(empty.path)
    assert not linked.is_full()
    for number in range(2):
        os.truncate(os.open(os.path.join(linked.path, f"{number}"), os.O_CREAT | os.O_WRONLY), 16 * MIB)
    assert linked.is_full(), "the link has a size too"


def test_a_disk_that_becomes_full_ends_the_zygote_and_the_play_fails_for_the_machine(tmp_path, monkeypatch):
    """A child can keep files that have no name any more. It is not blamed: another may have filled it."""
    one = Scratch(str(tmp_path))
    one.fill(str(tmp_path / "nothing"))
    free = os.statvfs(tmp_path)
    assert not one.fills_the_disk()
    child = os.fork()
    if child == 0:
        signal.pause()
        os._exit(0)
    handle = os.pidfd_open(child)
    try:
        left = os.statvfs_result((*free[:4], 0, *free[5:]))
        monkeypatch.setattr(os, "statvfs", lambda path: left)
        with pytest.raises(OSError, match="nearly full"):
            zygote._watch(child, handle, one)
        assert not select.select([handle], [], [], 0)[0]
    finally:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        os.close(handle)


def _until(found, seconds=5.0):
    until = time.monotonic() + seconds
    while not (it := found()) and time.monotonic() < until:
        time.sleep(0.01)
    return it
