"""A guest that imports SciPy and matplotlib only when they are used: every submission ends as in a guest that
has imported them.
"""

import importlib
import json
import os
import subprocess
import sys
import time
from dataclasses import replace
from types import ModuleType

import pytest

from exercises.authoring.assignments.assignment import ArraySpec
from polhode.judging.outcome import Ended
from service.sandbox.guest.zygote import NEEDED
from service.sandbox.isolation.guest_files import GUEST
from service.sandbox.job import Cell, Job, SceneRequest
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import TimeBudget, TimeLimits

SETUP = """
import matplotlib.pyplot as plt
from ecp.style import use_style

plt.rcParams["animation.html"] = "jshtml"
use_style()
"""
QUICK = {
    "call",
    "class",
    "version",
    "unknown setting",
    "unknown name",
    "exit code",
    "integration",
    "rotation",
}  # one of each way
PLAYS = "def ask(student, inputs):\n    return {'x': student['f']()}"
INTEGRATES = """
from polhode.judging.integration import integrate

def ask(student, inputs):
    def rates(y, out):
        def evaluate(t):
            out[0] = -y[0]
        return evaluate
    return {"x": integrate(rates, [1.0], [0.0, 1.0], 1e-11, 1e-13)[0, -1]}
"""
IMPORTS = """
import matplotlib
import matplotlib.pyplot as plt
import mpl_toolkits.mplot3d.art3d
from matplotlib import animation, pyplot
from matplotlib.animation import FuncAnimation
from mpl_toolkits.mplot3d import Axes3D
import scipy
import scipy.integrate as integrators
from scipy import optimize, special
from scipy.integrate import quad, solve_ivp
from scipy.spatial.transform import Rotation
"""
UNUSED = {
    "imported": "f = lambda: 1.0",
    "a function named as its module": "from scipy.optimize import least_squares\nf = lambda: 1.0",
    "named": (
        "def f(anim: FuncAnimation = None, axes=Axes3D, p=pyplot, a=animation.PillowWriter):\n    return 1.0"
    ),
    "same module": "f = lambda: float(matplotlib.pyplot is plt and plt.figure is not None)",
    "named functions of SciPy": (
        "def f(solve=solve_ivp, R=Rotation, root=optimize.brentq, r=scipy.integrate):\n    return 1.0"
    ),
    "replaced": "scipy.integrate.solve_ivp = lambda *a: 2.0\nf = lambda: scipy.integrate.solve_ivp()",
    "numpy alone": (
        "import numpy as np\nf = lambda: float(np.linalg.norm([3.0, 4.0]) + np.fft.fft([1.0])[0].real)"
    ),
    "choice of a backend": (
        "matplotlib.use('WXAgg', force=True)\nplt.switch_backend('QtAgg')\n"
        "plt.rcParams['backend'] = 'nbAgg'\n"
        "f = lambda: 1.0"
    ),
    "uses in functions that are not called": (
        "def film():\n    return FuncAnimation(plt.figure(), print), solve_ivp(print, (0, 1), [1])\n"
        "f = lambda: 1.0"
    ),
}
USED = {
    "call": "plt.figure()\nf = lambda: 1.0",
    "class": "class Film(FuncAnimation):\n    pass\nf = lambda: 1.0",
    "isinstance": "f = lambda: float(isinstance(1, FuncAnimation))",
    "union": "kind = FuncAnimation | None\nf = lambda: 1.0",
    "equality": "f = lambda: float(FuncAnimation == plt.figure)",
    "hash": "f = lambda: float(len({FuncAnimation, plt.figure}))",
    "text": "f = lambda: float(len(f'{FuncAnimation}'))",
    "attribute": "f = lambda: float(hasattr(FuncAnimation, 'save'))",
    "version": "f = lambda: float(matplotlib.__version__[0])",
    "settings": "plt.rcParams['figure.dpi'] = 50\nf = lambda: plt.rcParams['figure.dpi']",
    "settings by update": "plt.rcParams.update({'figure.dpi': 50})\nf = lambda: 1.0",
    "unknown setting": "plt.rcParams['nothing'] = 1\nf = lambda: 1.0",
    "unknown name": "from matplotlib.pyplot import nothing\nf = lambda: 1.0",
    "unknown attribute": "f = lambda: float(plt.nothing is None)",
    "unknown module": "import matplotlib.nothing\nf = lambda: 1.0",
    "star": "from matplotlib.pyplot import *\nf = lambda: float(len(get_fignums()))",
    "constant": "f = lambda: float(len(plt.color_sequences) > 0)",
    "compiled": "import matplotlib.ft2font\nf = lambda: 1.0",
    "exit code": f"import os\nf = lambda: os._exit({NEEDED['matplotlib']})",
}


USES_SCIPY = {
    "integration": "f = lambda: float(solve_ivp(lambda t, y: -y, (0, 1), [1.0], method='DOP853').y[0, -1])",
    "quadrature": "f = lambda: quad(lambda x: x, 0, 1)[0]",
    "module": "f = lambda: float(integrators.quad(abs, 0, 1)[0])",
    "root": "f = lambda: optimize.brentq(lambda x: x - 1, 0, 3)",
    "special function": "f = lambda: float(special.ellipk(0.5))",
    "rotation": "f = lambda: float(Rotation.from_rotvec([0, 0, 1]).magnitude())",
    "version of SciPy": "f = lambda: float(scipy.__version__[0])",
    "constant of SciPy": "from scipy.constants import g\nf = lambda: g",
    "compiled": "from scipy.linalg.lapack import dgesv\nf = lambda: 1.0",
    "unknown module": "import scipy.nothing\nf = lambda: 1.0",
}


def job(source):
    scene = SceneRequest("one", "ask", "f", {}, {"x": ArraySpec(())}, 2.0, None)
    return Job(SETUP, PLAYS, (Cell("submission.py", IMPORTS + source),), ("f",), (scene,))


@pytest.fixture(scope="module")
def unused(sandbox):
    """A sandbox whose guest imports libraries when a submission uses them, for submissions that do not."""
    without = Sandbox(sandbox.isolation, libraries=False)
    yield without
    without.close()


@pytest.fixture
def later(sandbox):
    """Another one, in which no submission has run yet."""
    other = Sandbox(sandbox.isolation, libraries=False)
    yield other
    other.close()


def without_times(result):
    return (
        result.scene_ends,
        result.cells,
        result.defined,
        {n: {k: v.tolist() for k, v in a.items()} for n, a in result.arrays.items()},
    )


@pytest.mark.parametrize("source", UNUSED.values(), ids=UNUSED)
def test_a_submission_that_only_imports_libraries_runs_without_them(unused, sandbox, source):
    result = unused.play(job(source))
    assert result.scene_ends["one"].ended is Ended.FINISHED and without_times(result) == without_times(
        sandbox.play(job(source))
    )
    assert not unused.start().imported


@pytest.mark.parametrize(
    "source",
    [
        pytest.param(source, id=id, marks=[] if id in QUICK else pytest.mark.slow)
        for id, source in USED.items()
    ],
)
def test_a_submission_that_uses_matplotlib_gets_it(later, sandbox, source):
    result = later.play(job(source))
    assert later.start().imported == {"matplotlib"} and later.zygotes == 1  # it was not replaced
    assert without_times(result) == without_times(sandbox.play(job(source)))


@pytest.mark.parametrize(
    "source",
    [
        pytest.param(source, id=id, marks=[] if id in QUICK else pytest.mark.slow)
        for id, source in USES_SCIPY.items()
    ],
)
def test_a_submission_that_uses_scipy_gets_it(later, sandbox, source):
    result = later.play(job(source))
    assert later.start().imported == {"scipy"} and without_times(result) == without_times(
        sandbox.play(job(source))
    )


def test_a_submission_that_uses_both_gets_both(later, sandbox):
    source = f"{USED['call']}\nf = lambda: special.ellipk(0.5)"
    result = later.play(job(source))
    assert later.start().imported == {"scipy", "matplotlib"} and without_times(result) == without_times(
        sandbox.play(job(source))
    )


def test_plays_integrate_without_importing_scipy(unused, sandbox):
    asked = replace(job("f = 1"), plays=INTEGRATES, variables=("f",))
    assert (
        without_times(unused.play(asked)) == without_times(sandbox.play(asked))
        and not unused.start().imported
    )


def test_what_is_printed_before_the_second_play_is_not_repeated(later):
    result = later.play(job(f"print('once')\n{USED['call']}"))
    assert result.stdout == "once\n"


@pytest.mark.parametrize(("name", "imported"), [("submission.py", False), ("cell 1", True)])
def test_only_a_notebook_is_graded_with_ipython(later, name, imported):
    """Its import takes longer than the grading of a plain Python file."""
    asks = "import sys\ndef f():\n    return float('IPy' 'thon' in sys.modules)\n"
    result = later.play(replace(job(asks), cells=(Cell(name, asks),)))
    assert result.arrays["one"]["x"] == imported
    assert later.start().imported == ({"ipython"} if imported else frozenset())


COMPUTE = "import os, time\nbegun = time.process_time()\nwhile time.process_time() < begun + 0.5: pass\n"


@pytest.mark.parametrize("uses", ["float(quad(abs, 0.0, 1.0)[0])", "os._exit(95)"])
def test_the_time_in_a_guest_without_the_library_is_the_submissions_too(later, uses):
    """The exit code that asks for a library is a submission's own word."""
    budget = TimeBudget(TimeLimits(60.0, 120.0))
    result = later.play(job(f"{COMPUTE}f = lambda: {uses}"), budget=budget)
    assert result.scene_ends["one"].ended is (Ended.FINISHED if "quad" in uses else Ended.EXITED)
    assert budget.cpu_s > 2 * 0.5


def test_an_exit_code_that_asks_for_a_library_does_not_extend_the_elapsed_time(later):
    budget = TimeBudget(TimeLimits(60.0, 2.0))
    began = time.monotonic()
    sleeps = "import os, time\ntime.sleep(1.5)\nf = lambda: os._exit(95)"
    result = later.play(job(sleeps), budget=budget)
    assert result.scene_ends["one"].ended is Ended.TIMED_OUT
    assert result.scene_ends["one"].sentence == "your submission did not finish within 2 s in all"
    assert time.monotonic() - began < 8.0


@pytest.mark.parametrize("guest", ["later", "sandbox"])
def test_a_submission_cannot_replace_the_kinds_of_questions_that_plays_import(guest, request):
    plays = "import polhode.kinds as kinds\ndef ask(student, inputs):\n"
    plays += "    return {'x': student['f']() * (kinds.agreement.__name__ == 'agreement')}"
    replaces, sandbox = (
        "import polhode.kinds\npolhode.kinds.agreement = print\n",
        request.getfixturevalue(guest),
    )
    for _ in range(2):
        asked = replace(job(f"{replaces}f = lambda: 1.0"), plays=plays)
        assert sandbox.play(asked).arrays["one"]["x"] == 1.0
        assert sandbox.play(job("f = lambda: 1.0")).finished("one")


def test_a_guest_imports_at_first_only_what_children_need(later):
    """Its start is most of the time of grading one file."""
    unneeded = {
        "polhode.client.course",
        "polhode.judging.exercise",
        "polhode.kinds",
        "email",
        "html",
        "importlib.resources",
        "matplotlib.figure",
    }
    asked = replace(
        job(""), setup="", cells=(Cell("submission.py", "import sys\nprint(*sys.modules)\nf = float"),)
    )
    printed = later.play(asked).stdout.split()
    assert "polhode.judging.integration" in printed and not unneeded.intersection(printed)


MODULES = [
    "scipy.cluster.hierarchy", "scipy.fft", "scipy.integrate", "scipy.interpolate", "scipy.linalg",
    "scipy.ndimage", "scipy.optimize", "scipy.signal", "scipy.sparse", "scipy.sparse.linalg", "scipy.spatial",
    "scipy.spatial.transform", "scipy.special", "scipy.stats",
]  # fmt: skip
"""The public modules of SciPy that a course uses."""
AS_NAMES = """
import importlib, json, os, sys
from types import ModuleType

class Needed(Exception):
    pass

def need(code):
    raise Needed

os._exit = need
from guest import deferred_libraries
deferred_libraries.install()
kinds = {}
for module, names in json.load(sys.stdin).items():
    for name in names:
        try:
            value = getattr(importlib.import_module(module), name)
            kinds[f"{module}.{name}"] = issubclass(type(value), ModuleType)
        except Needed:
            pass  # the library is then imported
print(json.dumps(kinds))
"""


def test_a_public_name_of_scipy_is_no_module_where_it_is_a_function():
    public = {name: importlib.import_module(name).__all__ for name in MODULES}
    path = os.pathsep.join([str(GUEST.parent), os.environ.get("PYTHONPATH", "")])
    found = json.loads(
        subprocess.run(
            [sys.executable, "-c", AS_NAMES],
            input=json.dumps(public),
            env=os.environ | {"PYTHONPATH": path},
            capture_output=True,
            check=True,
            text=True,
        ).stdout
    )
    real = {
        f"{module}.{name}": isinstance(getattr(importlib.import_module(module), name), ModuleType)
        for module, names in public.items()
        for name in names
    }
    assert len(found) > 200
    assert {name for name, kind in found.items() if kind != real[name]} == set()
