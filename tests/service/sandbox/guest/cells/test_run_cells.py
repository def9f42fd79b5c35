"""Cells as Jupyter runs them, by their effect: what a notebook's names are after they ran in the sandbox."""

from dataclasses import replace

import numpy as np
import pytest

from exercises.authoring.assignments.assignment import ArraySpec
from polhode.judging.outcome import Ended
from service.sandbox.job import Cell, Job, SceneRequest

PLAYS = """
import numpy as np

def read(student, inputs):
    return {"x": np.array([float(student["x"])])}
"""
CALLED = """
def called(student, inputs):
    return {"x": np.array([float(student["x"]())])}
"""
PLT = "import matplotlib.pyplot as plt"
READ = SceneRequest("read", "read", "x", {}, {"x": ArraySpec((1,))}, 5.0, None)


def notebook(*cells, names=("x",), load_s=10.0):
    numbered = tuple(Cell(f"cell {number}", source) for number, source in enumerate(cells, start=1))
    return Job("", PLAYS, numbered, names, (READ,), load_s, variables=names)


def script(source, names=("x",)):
    return Job("", PLAYS, (Cell("submission.py", source),), names, (READ,), variables=names)


def value(played):
    assert played.finished("read"), played.scene_ends | played.cells
    return played.arrays["read"]["x"][0]


@pytest.mark.parametrize(
    "cells",
    [
        ["%matplotlib inline\nx = 1"],
        ["x = 1\n!ls -l\ny = 2"],
        ["%%time\ny = 0\nx = 1"],
        ["%%capture out\nprint('quiet')\nx = 1", "assert out.stdout == 'quiet\\n'\nx = 1"],
        ["%%bash\nx = 2", "x = 1"],
        ["if True:\n    %time x = 1"],
        ["text = '''\n%not a magic\n'''\nx = 1 if text == '\\n%not a magic\\n' else 0"],
        ["x = 7 \\\n% 6"],
        ["files = !ls\nx = 1 + len(files)"],
        ["    x = 1\n    %pwd"],
        ["pip install numpy\nx = 1"],
        ["%pip install --quiet pandas\n%conda install x\nx = 1"],
        ["5 - 4", "x = _"],
        ["'in'; 1", "x = Out[1]", "assert In[1].startswith(\"'in'\")\nx = 1"],
        [f"{PLT}\nplt.axes(projection='3d')", "plt.fill_between([0, 1], [0, 1])\nx = 1"],
        [f"{PLT}\nplt.figure()\nplt.show()\nx = 1 + len(plt.get_fignums())"],
        [f"{PLT}\nfig, ax = plt.subplots()", "ax.plot([0, 1])\nfig.canvas.draw()\nx = 1"],
        [f"{PLT}\nplt.Axes = 0\nfrom matplotlib._pylab_helpers import Gcf\nGcf.figs = None", "x = 1"],
        ["from __future__ import annotations", "def f(y: Missing) -> Absent:\n    return 1\nx = f(0)"],
        ["import asyncio\nasync def one():\n    await asyncio.sleep(0.001)\n    return 1", "x = await one()"],
        ["async def count():\n    for k in (0, 1):\n        yield k\nasync for x in count():\n    pass"],
        ["import asyncio\nasync def one():\n    return 1\nx = sum(await asyncio.gather(one())) "],
        ["from IPython.core.interactiveshell import InteractiveShell\nx = 0",
         "InteractiveShell.ast_node_interactivity = 'all'", "1\n2\nx = 1", "assert Out[3] == 2"],
        ["import IPython.lib\nfrom IPython import get_ipython\nx = int(IPython.__version__ > '8')"],
        ["from IPython.display import HTML, Image, Latex, Math, Markdown, clear_output, display\n"
         "display(HTML('<b>1</b>'), Math('x'))\nclear_output()\nx = 1"],
        ["from IPython.core.magic import register_line_magic\n"
         "@register_line_magic\ndef one(line):\n    return 1", "x = %one"],
        ["%load_ext autoreload\n%autoreload 2\n%config InlineBackend.figure_format = 'retina'\nx = 1"],
        ["runs = []\n%timeit -n 1000 -r 7 runs.append(1)\nx = len(runs)"],
        ["runs = []", "%%timeit\nruns.append(1)", "x = len(runs)"],
        ["runs = []\n%prun runs.append(1)\nx = len(runs)"],
        ["took = %timeit -o -q sum(range(9))\nx = float(took.average >= 0)"],
        ["%pylab\nx = cos(0)"],
        ["x = 1\nexit()"],
    ],
)  # fmt: skip
def test_a_cell_does_what_it_does_in_a_notebook(cells, sandbox):
    assert value(sandbox.play(notebook(*cells))) == 1


@pytest.mark.parametrize(
    "escape", ["!rm -r /", "%system ls", "!!ls", "%%bash\nls", "%pip install pandas", "%sx ls"]
)
def test_an_escape_says_in_one_line_that_there_is_no_shell(escape, sandbox):
    played = sandbox.play(notebook(escape, "x = 1"))
    (line,) = [line for line in played.stdout.splitlines() if "shell" in line]
    assert line.startswith("the grader has no shell: `") and not played.cells and value(played) == 1


def test_a_file_keeps_its_figures_until_it_shows_them(sandbox):
    shows = "open = len(plt.get_fignums())\nplt.show()\nx = open - len(plt.get_fignums())"
    assert value(sandbox.play(script(f"{PLT}\nplt.figure()\n\n# %%\n{shows}"))) == 1


@pytest.mark.parametrize(
    "make_folder", ["!mkdir -p out/a", "import os\nos.system('mkdir out')", "%mkdir out", "x = 0"]
)
def test_a_file_is_written_in_a_folder_of_the_students_disk(make_folder, sandbox):
    cells = [
        make_folder,
        "with open('out/b.txt', 'w') as file:\n    file.write('1')",
        "x = int(open('out/b.txt').read())",
    ]
    played = sandbox.play(notebook(*cells))
    assert not played.cells and value(played) == 1


def test_lines_keep_their_numbers(sandbox):
    played = sandbox.play(notebook("\n\n%%time\nx = 1\n1 / 0", "\n \ny = 2\nz", "x = 1"))
    assert [end.traceback.splitlines()[0].strip() for end in played.cells.values()] == [
        'File "cell 1", line 5, in <module>',
        'File "cell 2", line 4, in <module>',
    ]


def test_display_prints_plain_text_and_a_value_prints_nothing(sandbox):
    played = sandbox.play(notebook("display({'a': 1})\n{'b': 2}", "{'c': 3}\nx = 1"))
    assert played.stdout == "{'a': 1}\n"


@pytest.mark.parametrize("make", [notebook, script])
def test_after_a_failure_imports_and_definitions_still_run(make, sandbox):
    source = "import math\n1 / 0\nlost = 2\nfrom math import cos\ndef f(y):\n    return cos(y)\nx = f(0)"
    played = sandbox.play(make(source) if make is script else make(source, "x = f(0)"))
    (ended,) = played.cells.values()
    assert ended.sentence == "ZeroDivisionError: division by zero" and "line 2" in ended.traceback
    if make is notebook:
        assert value(played) == 1
    else:
        assert "x is not defined because submission.py stopped" in played.scene_ends["read"].sentence
        assert played.missing == {"x"} and not played.defined


def test_after_a_failure_an_old_draft_does_not_replace_a_right_function(sandbox):
    cells = "def f():\n    return 1", "1 / 0\ndef f():\n    return 2\nclass g:\n    pass", "x = f()\ng()"
    assert value(sandbox.play(notebook(*cells))) == 1


def test_the_first_cause_is_the_named_cause(sandbox):
    cells = "import pandas as pd", "frame = pd.DataFrame()", "x = frame.mean()"
    played = sandbox.play(notebook(*cells))
    told = [end.sentence for end in played.cells.values()]
    cause = "is missing because cell 1 stopped: ModuleNotFoundError: No module named 'pandas'"
    assert told[1:] == [f"`pd` {cause}", f"`frame` {cause}"]
    assert (
        played.scene_ends["read"].sentence
        == f"x is not defined because {cause.removeprefix('is missing because ')}"
    )


def test_a_name_that_nothing_was_to_bind_blames_no_cell(sandbox):
    played = sandbox.play(notebook("import pandas", "x = nowhere"))
    assert [*played.cells.values()][1].sentence == "NameError: name 'nowhere' is not defined"


def test_a_syntax_error_costs_the_names_of_its_cell(sandbox):
    played = sandbox.play(notebook("y = 1\n\ndef x():\n    return 1 1", "z = y"))
    first, second = played.cells.values()
    assert first.ended is Ended.SYNTAX and second.sentence.startswith(
        "`y` is missing because cell 1 stopped: Syntax"
    )
    assert played.scene_ends["read"].code == "syntax-error" and played.missing == {"x"}


ENDINGS = {
    "import os\nos._exit(0)": "your code ended the Python process",
    "import ctypes\nctypes.string_at(0)": "the Python process crashed",
    "while True:\n    print('x' * 1000)": "your code printed or returned far too much",
    "while True:\n    pass": "your code used more than 1 s of CPU time",
    "while True:\n    try:\n        while True: pass\n    except BaseException:\n        pass": "your code",
    "import os, signal\nos.kill(os.getpid(), signal.SIGKILL)": "the Python process crashed",
}


@pytest.mark.parametrize("make", ["notebook", "script"])
@pytest.mark.parametrize("statement", ENDINGS)
def test_a_statement_that_ends_the_process_is_left_out(statement, make, sandbox):
    before, after = "def f():\n    return 1", "x = f()"
    if make == "notebook":
        played = sandbox.play(notebook(before, statement, after, load_s=1.0))
    else:
        job = script("\n".join([before, statement, after]))
        played = sandbox.play(Job(job.setup, PLAYS, job.cells, ("x",), (READ,), 1.0, variables=("x",)))
    assert value(played) == 1
    (ended,) = played.cells.values()
    assert ended.sentence.startswith(ENDINGS[statement])
    assert ended.sentence.endswith("; this statement was left out, and the others were run again")
    assert statement.split("\n")[-1].strip() in ended.traceback or "line" in ended.traceback


def test_what_an_ended_statement_was_to_bind_is_missing(sandbox):
    played = sandbox.play(notebook("import os\ny = os._exit(0)", "x = y"))
    cause = "cell 1 stopped: your code ended the Python process"
    assert played.cells["cell 2"].sentence == f"`y` is missing because {cause}"


def test_what_fails_because_a_statement_was_left_out_names_that_cause(sandbox):
    fills = "import os\nfound = []\nfor k in range(3):\n    found.append(os._exit(k))"
    played = sandbox.play(notebook(f"{fills}\nlargest = max(found)\nx = 2 * largest"))
    told = played.scene_ends["read"].sentence
    assert told == "x is not defined because cell 1 stopped: your code ended the Python process"


def test_three_statements_are_left_out_and_no_fourth(sandbox):
    three = ["import os", *["os._exit(0)"] * 3, "x = 1"]
    assert value(sandbox.play(notebook(*three))) == 1
    played = sandbox.play(notebook("import os", *["os._exit(0)"] * 4, "x = 1"))
    assert played.scene_ends["read"].ended is Ended.EXITED


def test_of_many_slow_cells_the_costliest_are_left_out(sandbox):
    slow = [f"y = 0\nwhile y < 10**{n}:\n    y += 1" for n in (5, 5, 9, 5)]
    played = sandbox.play(notebook(*slow, "x = 1", load_s=0.5))
    assert value(played) == 1 and [*played.left_out] == [("cell 3", 2, 0)]


def test_when_the_time_is_spent_for_good_definitions_still_run(sandbox):
    endless = ["while True:\n    pass"] * 4
    cells = "def f():\n    return 1", *endless, "1 / 0\nclass g:\n    pass\ndef x():\n    return 1"
    job = notebook(*cells, load_s=0.3)
    read = replace(READ, inputs={}, play="called")
    job = replace(job, plays=PLAYS + CALLED, scenes=(read,), variables=())
    played = sandbox.play(job)
    assert value(played) == 1 and len(played.left_out) == 3
    assert played.cells["cell 5"].sentence.endswith("; of the statements after it, only definitions were run")


@pytest.mark.parametrize("make", [notebook, script])
def test_sys_exit_is_left_out_with_a_remark(make, sandbox):
    played = sandbox.play(make("import sys\nif True:\n    sys.exit(1)\nx = 1"))
    (ended,) = played.cells.values()
    assert value(played) == 1 and ended.ended is Ended.EXITED and "sys.exit() was left out" in ended.sentence


def test_sys_exit_at_the_end_of_a_script_needs_no_remark(sandbox):
    assert not sandbox.play(script("import sys\nx = 1\nsys.exit(0)")).cells


@pytest.mark.parametrize(
    "swallowed",
    [
        "def handler(self, etype, value, tb, tb_offset=None):\n    return []\n"
        "get_ipython().set_custom_exc((BaseException,), handler)",
        "ip = get_ipython()\nip.showtraceback = ip.run_ast_nodes = lambda *a, **k: None",
        "get_ipython().events.register('pre_run_cell', lambda info: None)",
    ],
)
def test_the_time_limit_holds_whatever_catches_it(swallowed, sandbox):
    played = sandbox.play(notebook(swallowed, "while True:\n    pass", "x = 1", load_s=1.0))
    assert played.cpu_s < 10
    assert any("CPU time" in end.sentence for end in played.cells.values()) or not played.finished("read")


def test_a_displayed_animation_is_shown_and_values_are_kept(sandbox):
    played = sandbox.play(notebook("import numpy as np\nx = np.float64(1)\nx"))
    assert np.isclose(value(played), 1)
