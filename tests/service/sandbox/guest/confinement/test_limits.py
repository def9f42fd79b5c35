"""What meets a limit of the sandbox ends with a sentence that names it and says what to do."""

import sys

import pytest

from exercises.authoring.assignments.assignment import ArraySpec
from polhode.judging.outcome import Ended
from service.sandbox.guest.confinement import limits
from service.sandbox.job import Cell, Job, SceneRequest

PLAYS = "def play(names, inputs):\n    return {'x': names['f']()}\n"
PROCESSES = "the grader starts no processes: "
THREADS = "the grader starts no threads: "
NETWORK = "the grader has no network: "
INPUT = "the grader cannot ask for input: "
REFUSED = {
    "import multiprocessing\nwith multiprocessing.Pool(3) as pool:\n    pool.map(abs, [-1])": PROCESSES,
    "import multiprocessing as mp\nmp.Process(target=print).start()": PROCESSES,
    "from multiprocessing import Queue\nqueue = Queue()": PROCESSES,
    "from multiprocessing.pool import ThreadPool\nThreadPool(2)": PROCESSES,
    "from concurrent.futures import ProcessPoolExecutor\nProcessPoolExecutor().submit(abs, 1)": PROCESSES,
    "import subprocess\nsubprocess.run(['make'], check=True)": PROCESSES,
    "from subprocess import Popen, PIPE\nPopen('make', shell=True, stdout=PIPE)": PROCESSES,
    "import subprocess as sp\ntry:\n    sp.check_output('make')\nexcept OSError as error:\n"
    "    raise RuntimeError('cannot build') from error": PROCESSES,
    "import os\nos.popen('make').read()": PROCESSES,
    "import os\nif not os.fork():\n    os._exit(0)": PROCESSES,
    "from os import fork\nfork()": PROCESSES,
    "import os\nos.execvp('make', ['make'])": PROCESSES,
    "from scipy.optimize import differential_evolution\n"
    "differential_evolution(abs, [(0, 1)], workers=2)": PROCESSES,
    "from concurrent.futures import ThreadPoolExecutor\nwith ThreadPoolExecutor() as pool:\n"
    "    list(pool.map(abs, [-1]))": THREADS,
    "import threading\nthreading.Thread(target=print).start()": THREADS,
    "from threading import Timer\nTimer(0.1, print).start()": THREADS,
    "import _thread\n_thread.start_new_thread(print, ())": THREADS,
    "import numpy, scipy.fft\nscipy.fft.fft(numpy.ones((64, 64)), workers=2)": THREADS,
    "import asyncio\nasyncio.run(asyncio.to_thread(abs, 1))": THREADS,
    "import socket\nsocket.socket().connect(('example.org', 80))": NETWORK,
    "import socket\nsocket.gethostbyname('example.org')": NETWORK,
    "from urllib.request import urlopen\nurlopen('http://example.org/data.csv')": NETWORK,
    "import urllib.request\nurllib.request.urlretrieve('https://example.org/a.csv', 'a.csv')": NETWORK,
    "import http.client\nhttp.client.HTTPConnection('example.org').request('GET', '/')": NETWORK,
    "from http.client import HTTPSConnection": NETWORK,
    "import ftplib\nftplib.FTP('example.org')": NETWORK,
    "import numpy\nnumpy.loadtxt('https://example.org/data.csv')": NETWORK,
    "import asyncio\nasyncio.run(asyncio.open_connection('example.org', 80))": NETWORK,
    "n = int(input('How many? '))": INPUT,
    "ask = input\nask()": INPUT,
    "import getpass\ngetpass.getpass()": INPUT,
    "from getpass import getpass as secret\nsecret('Password: ')": INPUT,
    "breakpoint()": INPUT,
    "import tkinter": "the grader does not have `tkinter`: ",
    "raise ModuleNotFoundError('as on Debian', name='curses')": "the grader does not have `curses`: ",
    "open('/etc/motd', 'w')": "the grader opens files only in the working folder: ",
    "import os\nos.nice(5)": "the grader does not allow this: ",
}
ORDINARY = (
    "raise OSError('no such sample')",
    "raise RuntimeError('diverged')",
    "open('data/missing.csv')",
    "import pathlib\npathlib.Path('missing.txt').read_text()",
    "import numpy\nnumpy.loadtxt('missing.csv')",
    "import pickle, io\npickle.load(io.BytesIO(b''))",
    "raise OSError('see https://example.org')",
    "from math import sinus",
    "try:\n    input()\nexcept EOFError:\n    1 / 0",
)
NEWER = (
    'print(f"{data["mass"]:.3f} kg")',
    "label = f'{', '.join(names)}'",
    'print(f"{f"{f"{1}"}"}")',
    "text = f'{'\\n'.join(rows)}'",
    'text = f"""{\n    1 # one\n}"""',
    'x = f"{\n    1 + 2}"',
    'x = f"{norm(\n    w)}"',
    'print(fr"$\\alpha$ {d["α"]}")',
    "type Vector = list[float]",
    "type Pair[T] = tuple[T, T]",
    "def first[T](items: list[T]) -> T:\n    return items[0]",
    "async def last[T: int](items): pass",
    "class Stack[T]:\n    pass",
    "try:\n    f()\nexcept KeyError, np.linalg.LinAlgError:\n    pass",
    "greeting = t'{name} and others'",
)
ORDINARY_SYNTAX = (
    'print(f"{x")',
    'print(f"{x", "}")',
    'print(f"x = {x)',
    'f"{}"',
    'f"x}"',
    'f"{a b}"',
    "type X",
    "def f[x]:\n    return x",
    "def f(x:\n    pass",
    "try:\n    f()\nexcept KeyError, e:\n    pass",
    "print('don't')",
    'print "hello"',
    "return m m / 12",
    "if x = 1: pass",
    "d = {'a': 1 'b': 2}",
    "s = f\"{d['a'}\"",
)


def ends(sandbox, source, name="submission.py"):
    scene = SceneRequest("scene", "play", "f", {}, {"x": ArraySpec(())}, 5.0, None)
    return sandbox.play(Job("", PLAYS, (Cell(name, source),), ("f",), (scene,)))


def inside(source):
    lines = "\n".join(f"    {line}" for line in source.split("\n"))
    return f"def f():\n{lines}\n    return 1.0\n"


@pytest.mark.parametrize("source", REFUSED)
def test_while_the_cells_run(sandbox, source):
    result = ends(sandbox, f"{source}\ndef f():\n    return 1.0\n")
    (cell,) = result.cells.values()
    assert cell.ended is Ended.RAISED and cell.sentence.startswith(REFUSED[source])
    assert result.finished("scene")  # what does not depend on it is there


@pytest.mark.parametrize("source", REFUSED)
def test_in_a_function(sandbox, source):
    end = ends(sandbox, inside(source), "cell 1").scene_ends["scene"]
    assert end.ended is Ended.RAISED and end.sentence.startswith(REFUSED[source])
    assert end.sentence.endswith(")") and str(end.line()).startswith("cell 1, line ")


@pytest.mark.parametrize("source", ORDINARY)
def test_other_exceptions_stay_as_they_are(sandbox, source):
    end = ends(sandbox, inside(source)).scene_ends["scene"]
    assert end.ended is Ended.RAISED and "the grader" not in end.sentence


def test_a_command_of_the_shell_is_not_run_and_says_so(sandbox):
    result = ends(sandbox, "import os\nstatus = os.system('make all')\ndef f(): return float(status)\n")
    assert result.stdout == "the grader has no shell: `make all` was not run\n"
    assert result.finished("scene") and result.arrays["scene"]["x"] == -1


def syntax_error(source):
    with pytest.raises(SyntaxError) as caught:
        compile(source, "cell 1", "exec")
    return limits.limit(caught.value)


@pytest.mark.skipif(sys.version_info >= (3, 12), reason="this Python understands most of it")
@pytest.mark.parametrize("source", NEWER)
def test_newer_syntax_names_the_version_of_the_server(source):
    assert f"Python {sys.version_info.major}.{sys.version_info.minor}:" in syntax_error(source)


@pytest.mark.parametrize("source", ORDINARY_SYNTAX)
def test_an_ordinary_syntax_error_names_no_version(source):
    assert not syntax_error(source)


def test_newer_syntax_in_the_sandbox(sandbox):
    for name in ("submission.py", "cell 1"):
        result = ends(sandbox, f"{NEWER[0]}\ndef f():\n    return 1.0\n", name)
        (cell,), end = result.cells.values(), result.scene_ends["scene"]
        assert cell.sentence.startswith("the grader runs Python ") and cell.ended is Ended.SYNTAX
        assert end.because == f"{name} stopped: {cell.sentence}" and end.traceback == cell.traceback
