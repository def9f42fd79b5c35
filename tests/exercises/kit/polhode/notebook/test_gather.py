"""What a live notebook sends: its text runs alone and answers as the notebook does."""

import ast
import atexit
import functools
import json
import sys
import types

import numpy as np
import pytest
from IPython.core.interactiveshell import InteractiveShell
from traitlets.config import Config

from polhode.notebook.cell_to_python import python_of
from polhode.notebook.gather import CannotSend, gather, whole_notebook


class Notebook:
    """A kernel without a front end: cells go in, bundles come out."""

    def __init__(self, shell):
        self.shell = shell

    def run(self, *cells, fails=False):
        for cell in cells:
            assert self.shell.run_cell(cell, store_history=True).success is not fails

    def __getitem__(self, name):
        return self.shell.user_ns[name]

    @property
    def cells(self):
        return self.shell.history_manager.input_hist_raw

    def gather(self, *names, **more):
        functions = [self.shell.user_ns[name] for name in names]
        return gather(*functions, namespace=self.shell.user_ns, cells=self.cells, **more)

    def sent(self, name="f", left_out=()):
        """The function as a server has it; and the bundle is the same a second time."""
        bundle = self.gather(name)
        assert [out.name for out in bundle.left_out] == list(left_out)
        assert bundle.source == self.gather(name).source
        return alone(bundle)[name]


def alone(bundle):
    fresh = {"__name__": "__main__"}
    exec(compile(bundle.source, "bundle", "exec"), fresh)
    return fresh


@pytest.fixture
def notebook(capsys):
    main = sys.modules["__main__"]
    config = Config()
    config.HistoryManager.enabled = False
    config.HistoryManager.hist_file = ":memory:"
    shell = InteractiveShell(config=config)
    yield Notebook(shell)
    atexit.unregister(shell.atexit_operations)  # each would collect all garbage when the process ends
    sys.modules["__main__"] = main


def test_a_plain_function(notebook):
    notebook.run("import numpy as np", "def f(t, w, I):\n    # Euler\n    return -np.cross(w, I * w) / I")
    bundle = notebook.gather("f")
    assert (
        bundle.source
        == "import numpy as np\n\n\ndef f(t, w, I):\n    # Euler\n    return -np.cross(w, I * w) / I\n"
    )
    assert bundle.names == ("f",) and bundle.left_out == ()
    assert len(bundle.sha256) == 64
    w, I = np.array([1.0, 2, 3]), np.array([3.0, 2, 1])
    assert np.array_equal(alone(bundle)["f"](0, w, I), notebook["f"](0, w, I))


def test_the_current_function_counts_not_the_newest_text_of_that_name(notebook):
    notebook.run("def f(x):\n    return 1", "first = f", "def f(x):\n    return 2")
    assert notebook.sent()(0) == 2
    notebook.run("f = first")
    assert notebook.sent()(0) == 1


def test_a_cell_that_failed_before_its_definition_is_not_believed(notebook):
    notebook.run("def f(x):\n    return 1")
    notebook.run("1 / 0\ndef f(x):\n    return 2", fails=True)
    assert notebook.sent()(0) == 1


def test_an_older_function_under_a_new_name(notebook):
    notebook.run(
        "def f(n):\n    return 'old'",
        "g = f",
        "def f(n):\n    return 'new'",
        "def both(n):\n    return f(n), g(n)",
    )
    assert notebook.sent("both")(0) == ("new", "old")
    assert notebook.sent("g")(0) == "old"


def test_a_second_name_of_the_same_function(notebook):
    notebook.run("def f(n):\n    return 1 if n < 1 else n * f(n - 1)", "g = f")
    assert notebook.gather("g").names == ("f",)
    assert alone(gather("g", namespace=notebook.shell.user_ns, cells=notebook.cells))["g"](5) == 120


@pytest.mark.parametrize(
    "head", ["%%time", "%%capture", "%%capture out", "%%prun -q", "%%time\n%%capture", "\n\n%%time"]
)
def test_a_cell_magic_that_lets_python_through(notebook, head):
    notebook.run(f"{head}\nk = 3\ndef f(x):\n    return k * x")
    assert notebook.sent()(2) == 6


def test_imports_in_the_cell_of_the_definition(notebook):
    notebook.run(
        "%%time\nimport math\nimport numpy as np\ndef f(x):\n"
        "    return np.sum(x) + math.prod((2, x)) if x else f.__name__.upper()"
    )
    assert notebook.sent()(3) == 9
    notebook.run("%%time\ndef f(x):\n    if x:\n        x += 1\n        x *= 2\n    return x")
    notebook.run("1 / 0\ndef f(x):\n    if x:\n        x += 1\n    x *= 2\n    return x", fails=True)
    assert "        x *= 2" in notebook.gather("f").source


def test_a_definition_that_was_also_timed(notebook):
    namespace = {}
    exec("def f(x):\n    return x + 1", namespace)
    bundle = gather("f", namespace=namespace, cells=["%%timeit -n 1\ndef f(x):\n    return x + 1"])
    assert alone(bundle)["f"](1) == 2


def test_line_magics_and_shell_lines_among_python(notebook):
    notebook.run(
        "%xmode Plain\n!true \\\n   --continued\n%time k = [1, 2]\ntext = '''\n%not a magic\n'''\n"
        "files = !echo it\\'s\nk?\ndef f(x):\n    return (text, 7\n        % 4, k)"
    )
    assert notebook.sent()(0) == ("\n%not a magic\n", 3, [1, 2])


def test_a_shell_line_inside_a_function_is_told(notebook):
    notebook.run("def f(x):\n    if x:\n        !true\n    return 5")
    assert notebook.sent(left_out=["get_ipython"])(0) == 5


def test_what_a_shell_line_answered_is_left_out(notebook):
    notebook.run("files = !echo a", "def f():\n    return files")
    notebook.sent(left_out=["files"])


def test_an_indented_cell(notebook):
    notebook.run("    def f(x):\n        return x\n    y = 2")
    assert notebook.sent()(4) == 4


def test_a_lambda(notebook):
    notebook.run("k = 2; f = lambda x, y=(1,\n  2): k * x  # twice\nz = 3")
    assert notebook.gather("f").source == "k = 2\n\n\nf = lambda x, y=(1,\n  2): k * x\n"
    notebook.run("g = f", "def both(x):\n    return f(x) + g(x)")
    assert notebook.sent("both")(1) == 4


def test_a_partial(notebook):
    notebook.run("from functools import partial\ndef g(a, b):\n    return a - b", "f = partial(g, b=2)")
    assert notebook.sent()(5) == 3


def test_a_partial_of_a_function_that_has_changed_must_be_made_again(notebook):
    notebook.run(
        "import functools\ndef g(a):\n    return a", "f = functools.partial(g)", "def g(a):\n    return -a"
    )
    with pytest.raises(CannotSend, match="run that cell again"):
        notebook.gather("f")
    notebook.run("f = functools.partial(g)")
    assert notebook.sent()(5) == -5


def test_decorated_by_the_standard_library(notebook):
    notebook.run(
        "import functools\n@functools.lru_cache(maxsize=None)\ndef f(n):\n"
        "    return n if n < 2 else f(n - 1) + f(n - 2)"
    )
    assert notebook.sent()(50) == 12586269025


def test_decorated_by_a_decorator_of_the_notebook(notebook):
    notebook.run(
        "import functools\nscale = 3",
        "def twice(g):\n    @functools.wraps(g)\n    def wrapper(*a):\n        return 2 * scale * g(*a)\n"
        "    return wrapper",
        "@twice\ndef f(x):\n    return x + 1",
        "1",
        "def twice_again(g):\n    return lambda *a: 2 * g(*a)",
        "@twice_again\n@twice\ndef h(x):\n    return f(x)",
    )
    assert notebook.sent()(1) == 12
    assert notebook.sent("h")(1) == 144


def test_a_decorator_that_stands_later_than_what_it_decorates(notebook):
    deco = "def twice(g):\n    return lambda x: 2 * g(x)"
    notebook.run(deco, "@twice\ndef f(x):\n    return x", deco + "  # read again")
    assert notebook.sent()(1) == 2


@pytest.mark.slow
def test_decorated_by_a_compiler(notebook):
    pytest.importorskip("numba")
    notebook.run(
        "from numba import njit\n@njit\ndef g(x):\n    return x + 1\n\ndef f(x):\n    return g(x)",
        "h = njit(f)",
        "f = njit(f)",
    )
    assert "@njit\ndef g(x)" in notebook.gather("f").source
    assert notebook.sent()(1) == 2


def test_wrapped_by_an_assignment_to_its_own_name(notebook):
    notebook.run(
        "import numpy as np\ndef f(x):\n    return 0", "def f(x):\n    return x + 1", "f = np.vectorize(f)"
    )
    assert notebook.sent()([1, 2]).tolist() == [2, 3]
    notebook.run("def twice(g):\n    return lambda x: 2 * g(x)", "def h(x):\n    return x", "h = twice(h)")
    assert notebook.sent("h")(1) == 2


def test_an_instance_that_can_be_called(notebook):
    notebook.run(
        "class Rates:\n    def __init__(self, k):\n        self.k = k\n"
        "    def __call__(self, x):\n        return self.k * x * self.unit",
        "f = Rates(3)",
        "f.unit = 10",
    )
    assert notebook.sent()(2) == 60
    notebook.run("class Rates:\n    def __call__(self, x):\n        return 0")
    with pytest.raises(CannotSend, match="run that cell again"):
        notebook.gather("f")


def test_classes_and_dataclasses(notebook):
    notebook.run(
        "from dataclasses import dataclass, field\nclass Base:\n    unit = 2\n    def turn(self):\n"
        "        return self.unit",
        "default = 5.0\n@dataclass(frozen=True)\nclass Body(Base):\n    m: float = default\n"
        "    parts: list = field(default_factory=list)\n    @staticmethod\n    def new():\n"
        "        return Body()\n    @property\n    def twice(self):\n        return 2 * self.m",
        "def f():\n    b = Body.new()\n    return b.twice, b.turn(), b",
        "class Body2:\n    pass",
    )
    assert notebook.sent()()[:2] == (10.0, 2)
    assert repr(notebook.sent()()[2]) == "Body(m=5.0, parts=[])"


def test_the_current_class_counts(notebook):
    notebook.run(
        "class A:\n    def g(self):\n        return 1",
        "B = A",
        "class A:\n    def g(self):\n        return 2",
    )
    notebook.run("def f():\n    return A().g(), B().g()")
    assert notebook.sent()() == (2, 1)


def test_named_tuples(notebook):
    notebook.run(
        "from collections import namedtuple\nP = namedtuple('P', 'x y')",
        "p = P(1, 2)",
        "def f():\n    return p.x + P(3, 4).y",
    )
    assert notebook.sent()() == 5


def test_a_closure_is_sent_as_the_statement_that_made_it(notebook):
    notebook.run(
        "def make(I, sign=-1):\n    def euler(t, w):\n        return sign * helper(w) * I\n    return euler",
        "I0 = 2.5\ndef helper(x):\n    return x + 1",
        "f = make(I0)",
        "f(0, 1)",
    )
    assert notebook.sent()(0, 1) == -5.0
    notebook.run("def make(I, sign=1):\n    def euler(t, w):\n        return 0\n    return euler")
    with pytest.raises(CannotSend, match="run that cell again"):
        notebook.gather("f")


def test_two_functions_from_one_statement(notebook):
    notebook.run(
        "def pair(k):\n    return (lambda x: k * x), (lambda x: k + x)",
        "f, g = pair(3)",
        "def h(x):\n    return f(g(x))",
    )
    assert notebook.sent("h")(1) == 12
    assert notebook.gather("h").source.count("pair(3)") == 1
    notebook.run("g = 4.0", "def h(x):\n    return f(x) + g")
    assert notebook.sent("h")(1) == 7.0


def test_a_function_made_by_exec_cannot_be_sent(notebook):
    notebook.run("exec('def f(x):\\n    return x')", "def g(x):\n    return f(x)")
    with pytest.raises(CannotSend, match=r"(?s)source of `f` was not found.*submit\(file=...\)"):
        notebook.gather("f")
    (out,) = notebook.gather("g").left_out
    assert (out.name, out.needed_by) == ("f", "g")


def test_definitions_inside_blocks(notebook):
    notebook.run(
        "k = 2\nif k > 1:\n    def f(x):\n        '''A\n  text.'''\n        return k * x\nelse:\n"
        "    def f(x):\n        return 0",
        "try:\n    import not_there\nexcept ImportError:\n"
        "    @staticmethod\n    def g(x):\n        return f(x)\n    h = lambda x: g(x)",
        "for _k in range(2):\n    with open('/dev/null') as null:\n        def loop(x): return h(x) + 1",
    )
    assert notebook.sent()(3) == 6
    assert notebook.sent("loop")(3) == 7
    assert "open" not in notebook.gather("loop").source


def test_helpers_in_other_cells_and_mutual_recursion(notebook):
    notebook.run(
        "def odd(n):\n    return n > 0 and even(n - 1)",
        "def even(n):\n    return n == 0 or odd(n - 1)",
        "def unused():\n    return 0",
        "def f(n):\n    return helper(n)",
        "def helper(n):\n    return even(n)",
    )
    assert notebook.sent()(10) is True
    assert "unused" not in notebook.gather("f").source


def test_a_helper_redefined_after_the_main_function_is_sent_as_it_is_now(notebook):
    notebook.run(
        "def helper(x):\n    return 1", "def f(x):\n    return helper(x)", "def helper(x):\n    return 2"
    )
    assert notebook.sent()(0) == notebook["f"](0) == 2


def test_constants_are_sent_with_the_value_they_have_now(notebook):
    notebook.run(
        "import numpy as np\na = 1\nb = {'k': [1.5, -0.0, float('nan'), (np.inf, )], (1, 2): {3, 1}}",
        "c = 'ω²\\n', b'x', 1 - 2j, None, ()",
        "a += 1\nb['more'] = set(), frozenset([2]), range(3), True, -float('inf')",
        "d = np.float64(0.1) + np.float32(0.2), np.int8(3), np.nan, np.bool_(True)",
        "def f():\n    return a, b, c, d",
    )
    assert repr(notebook.sent()()) == repr(notebook["f"]())
    assert "a = 2\n" in notebook.gather("f").source


@pytest.mark.parametrize(
    "array",
    [
        "np.linspace(0, 1, 7) / 3",
        "np.arange(6).reshape(2, 3)",
        "np.array([[1.5, np.nan], [-np.inf, -0.0]], dtype=np.float32) / 3",
        "np.array(0.1)",
        "np.empty((0, 3))",
        "np.array(['ab', 'c'])",
        "np.array([1, 2], dtype='>i4')",
        "np.array([True, False])",
        "np.array([1 + 2j, complex(0, np.nan)])",
        "np.array([0.1], dtype=np.float16)",
        "np.random.default_rng(0).normal(size=(64, 64))",
        "np.eye(3)[:, ::2]",
        "np.array([b'a'])",
        "np.arange(3, dtype=np.longdouble) / 3",
        "np.array([1, None])",
        "np.zeros(3, dtype=[('a', float)])",
        "np.array(['2024-01-01'], dtype='datetime64[D]')",
        "np.ma.array([1.0, 2.0])",
        "np.zeros(100_000)",
    ],
)
def test_arrays_are_sent_exactly(notebook, array):
    notebook.run("import numpy as np", f"a = {array}", "def f():\n    return a")
    got, want = notebook.sent()(), notebook["a"]
    assert (got.dtype, got.shape, type(got)) == (want.dtype, want.shape, type(want))
    assert got.tobytes() == want.tobytes() or got.tolist() == want.tolist()


def test_arrays_where_np_is_something_else(notebook):
    notebook.run("import numpy\na = numpy.arange(3.0)\nnp = 'mine'", "def f():\n    return a, np")
    assert notebook.sent()()[1] == "mine"


def test_large_arrays_are_made_again_as_in_the_notebook(notebook):
    notebook.run(
        "import numpy as np\nn = 5000\ndef half(x):\n    return x / 2",
        "a = np.arange(n)\na = half(a)",
        "a[3] = n\nfor k in range(3):\n    a += k",
        "a.sort()",
        "def f():\n    return a",
    )
    assert np.array_equal(notebook.sent()(), notebook["a"])


def test_data_from_files_is_left_out_with_everything_made_of_it(notebook, tmp_path):
    path = tmp_path / "x.npy"
    np.save(path, np.zeros(5000))
    notebook.run(
        f"import numpy as np\ndef read():\n    return np.load({str(path)!r})",
        "data = read()",
        "half = data / 2\nfile = open('/dev/null')\nlines = (line for line in file)",
        "def f():\n    return half, lines, g()",
        "def g():\n    return 1",
    )
    bundle = notebook.gather("f")
    assert {out.name: out.needed_by for out in bundle.left_out} == {"half": "f", "lines": "f"}
    sentences = {out.name: out.sentence for out in bundle.left_out}
    assert (
        "`half` is made with `data`" in sentences["half"] and "compute it without them" in sentences["half"]
    )
    assert bundle.source == "def g():\n    return 1\n\n\ndef f():\n    return half, lines, g()\n"
    notebook["file"].close()


def test_a_function_that_cannot_run_without_what_is_left_out_is_refused(notebook):
    notebook.run(
        "exec('def g(x): return x')", "def f(x, how=g):\n    return how(x)", "def h(x):\n    return f(x)"
    )
    with pytest.raises(CannotSend, match="`f` is made with `g`"):
        notebook.gather("f")
    assert [out.name for out in notebook.gather("h").left_out] == ["f"]


def test_figures_of_the_notebook_are_made_again(notebook):
    notebook.run(
        "import matplotlib\nmatplotlib.use('Agg')\nimport matplotlib.pyplot as plt",
        "fig, ax = plt.subplots()\n(line,) = ax.plot([], [])",
        "ax.set_title('ω')",
        "def f(x):\n    line.set_data([0, 1], [x, x])\n    ax.set_xlabel('t')\n    return line, ax",
    )
    line, ax = notebook.sent()(3)
    assert ax.get_title() == "ω" and list(line.get_ydata()) == [3, 3] and line in ax.lines
    assert notebook.gather("f").source.count("def f(x)") == 1
    notebook["plt"].close("all")


def test_defaults_that_the_cell_would_not_give_today(notebook):
    notebook.run("k = 0.5\ndef f(x, *, a=k, b=2):\n    return a, b", "k = 0.5")
    assert notebook.sent()(0) == (0.5, 2)
    notebook.run("1 / 0\ndef f(x, *, a=k, b=3):\n    return a, b", fails=True)
    assert notebook.sent()(0) == (0.5, 2)
    notebook.run("k = 7")
    with pytest.raises(CannotSend, match="run that cell again"):
        notebook.gather("f")


def test_generators_and_other_objects_are_made_again(notebook):
    notebook.run(
        "import numpy as np\nfrom fractions import Fraction\nhalf = Fraction(1, 2)",
        "rng = np.random.default_rng(4)\nodd = (k for k in range(9) if k % 2)",
        "methods = {'a': lambda x: x + half, 'b': abs}",
        "def f():\n    return rng.normal(), list(odd), methods['a'](1), methods['b'](-1)",
    )
    assert notebook.sent()() == notebook["f"]()


def test_of_a_choice_the_whole_is_sent(notebook):
    notebook.run(
        "from fractions import Fraction\nfast = False\ns = Fraction(1)",
        "if fast:\n    s = Fraction(2)\nelse:\n    t = Fraction(3)",
        "def f():\n    return s",
    )
    assert notebook.sent()() == 1


def test_only_global_names_are_followed(notebook):
    notebook.run(
        "import math\nlocal = open('/dev/null')\nattribute = arg = inner = loop = local\nsize = 3\n"
        "class_level = local",
        "def g(arg, *, p=size):\n    local = arg\n    class K:\n        class_level = 1\n"
        "        def m(self):\n            return self.attribute\n    def inner():\n        nonlocal local\n"
        "        local += 1\n        return [loop for loop in range(local)]\n"
        "    math.attribute = K.class_level\n    import json as attribute\n"
        "    return inner(), len(str(local))",
        "def f(x: 'attribute') -> None:\n    return g(x)",
    )
    bundle = notebook.gather("f")
    assert bundle.left_out == () and "open" not in bundle.source and "size = 3" in bundle.source
    assert alone(bundle)["f"](2) == ([0, 1, 2], 1)
    notebook["local"].close()


def test_default_arguments_decorators_annotations_and_bases_are_needed_first(notebook):
    notebook.run(
        "from typing import NamedTuple\nimport numpy as np\nclass Zero(NamedTuple):\n    x: float = 1.0",
        "def start():\n    return other()",
        "def other():\n    return 7",
        "def f(t, y: Zero, z=start(), g=[k * start() for k in range(2)], h=lambda: later()) -> np.ndarray:\n"
        "    return t + z + h()",
        "def later():\n    return 100",
    )
    assert notebook.sent()(1, 2) == 108


def test_global_statements(notebook):
    notebook.run("count = 3\ndef f():\n    global count\n    count += 1\n    return count")
    assert notebook.sent()() == 4


def test_imports_are_sent_as_the_notebook_has_them(notebook):
    notebook.run(
        "import numpy as np, os.path as p\nfrom scipy.integrate import solve_ivp as solve\n"
        "from math import sin as s, pi",
        "import matplotlib as mpl\nimport matplotlib.animation\nfrom scipy import linalg",
        "def f(x):\n    import json\n    return np.cos(x) + s(x), pi, p.join('a', 'b'), json.dumps(1)",
        "def g():\n    return solve, mpl.animation.FuncAnimation, linalg.inv, matplotlib.animation",
    )
    assert notebook.gather("f").source.split("\n\n")[0].split("\n") == [
        "from math import pi",
        "from math import sin as s",
        "import numpy as np",
        "import os.path as p",
    ]
    assert notebook.sent()(0.5) == notebook["f"](0.5)
    assert notebook.gather("g").source.split("\n\n")[0].split("\n") == [
        "from scipy import linalg",
        "from scipy.integrate import solve_ivp as solve",
        "import matplotlib",
        "import matplotlib as mpl",
        "import matplotlib.animation",
    ]
    assert notebook.sent("g")() == notebook["g"]()


def test_of_a_star_import_the_used_names_are_sent(notebook):
    notebook.run(
        "from numpy import *\nnothing = None", "def f(x):\n    return sin(x) + sum(array([pi, x])), nothing"
    )
    assert "from numpy import sum" in notebook.gather("f").source
    assert notebook.sent()(1.0) == notebook["f"](1.0)


def test_names_that_no_cell_imports_are_found_in_public_modules(notebook):
    import scipy.integrate
    import scipy.optimize as optimize

    notebook.shell.user_ns.update(
        solve_ivp=scipy.integrate.solve_ivp, opt=optimize, sine=np.sin, cache=functools.lru_cache
    )
    notebook.run("@cache\ndef f():\n    return solve_ivp, opt, sine(1)")
    assert (
        "from scipy.integrate import solve_ivp\nimport scipy.optimize as opt" in notebook.gather("f").source
    )
    assert notebook.sent()() == notebook["f"]()


def test_imports_in_a_try(notebook):
    notebook.run(
        "try:\n    from not_there import sin\nexcept ImportError:\n    from math import sin",
        "def f(x):\n    return sin(x)",
    )
    assert notebook.gather("f").source.startswith("from math import sin\n")


def test_future_imports_come_first(notebook):
    notebook.run(
        "from __future__ import annotations",
        "def f(x: Unknown):\n    def g(y: Unknown):\n        return y\n    return g(x)",
    )
    assert notebook.gather("f").source.startswith("from __future__ import annotations\n\n\ndef f")
    assert notebook.sent()(1) == 1


def test_a_file_of_the_students_own(notebook, tmp_path, monkeypatch):
    (tmp_path / "my_rates.py").write_text("def rate(x):\n    return x\nk = 2\n")
    monkeypatch.syspath_prepend(tmp_path)
    notebook.run(
        "import my_rates\nfrom my_rates import rate, k", "def f(x):\n    return my_rates.rate(x) + k"
    )
    (out,) = notebook.gather("f").left_out
    assert out.name == "my_rates" and "my_rates.py: copy its code into a cell" in out.sentence
    with pytest.raises(CannotSend, match="copy its code into a cell"):
        notebook.gather("rate")


def test_what_belongs_to_the_kit_is_imported(notebook):
    notebook.run(
        "import polhode\nfrom polhode.report import figure_parts as d\n"
        "from polhode.animation.animate import show\nfrom polhode.report.figure_parts import FACE_COLORS"
    )
    notebook.run("def f():\n    return polhode, d, show, FACE_COLORS")
    assert notebook.gather("f").source.startswith(
        "from polhode.animation.animate import show\nfrom polhode.report import figure_parts as d\n"
        "from polhode.report.figure_parts import FACE_COLORS\nimport polhode\n"
    )
    notebook.shell.user_ns.update(show2=notebook["show"])
    notebook.run("def f():\n    return show2")
    assert notebook.gather("f").source.startswith("from polhode.animation.animate import show as show2\n")


def test_the_courses_package_in_the_cache_is_no_file_of_the_student(notebook, monkeypatch, tmp_path):
    folder = tmp_path / "polhode" / "assignments" / "tops" / "course"
    (folder / "optics").mkdir(parents=True)
    (folder / "optics" / "__init__.py").write_text("index = 1.5\n")
    monkeypatch.syspath_prepend(folder)
    notebook.run("import optics", "def f(x):\n    return optics.index * x")
    bundle = notebook.gather("f")
    assert bundle.source.startswith("import optics\n") and not bundle.left_out


def test_given_names_are_not_missed(notebook):
    notebook.run("def f(w, I):\n    return T_rot(w, I) + unknown")
    assert notebook.gather("f", given=["T_rot"]).source == "def f(w, I):\n    return T_rot(w, I) + unknown\n"
    notebook.run("def T_rot(w, I):\n    return 0")
    assert "def T_rot" in notebook.gather("f", given=["T_rot"]).source
    notebook.run("exec('def T_rot(w, I): return 1')")
    (out,) = notebook.gather("f", given=["T_rot"]).left_out
    assert out.sentence.endswith("(the server's own `T_rot` is used)")


def test_the_shells_own_names_are_not_sent(notebook):
    notebook.run("1 + 1", "def f():\n    exit, quit, open, print\n    return __name__, _1, Out")
    assert [out.name for out in notebook.gather("f").left_out] == ["Out", "_1"]


def test_functions_can_be_asked_for_by_name_or_as_they_were(notebook):
    notebook.run("def f():\n    return 1", "def g():\n    return 2")
    bundle = gather("f", "g", namespace=notebook.shell.user_ns, cells=notebook.cells)
    assert bundle.names == ("f", "g") and alone(bundle)["f"]() == 1
    old = notebook["f"]
    notebook.run("def f():\n    return 3")
    assert alone(gather(old, namespace=notebook.shell.user_ns, cells=notebook.cells))["f"]() == 1
    with pytest.raises(CannotSend, match="run the cell that defines it"):
        gather("nobody", namespace=notebook.shell.user_ns, cells=notebook.cells)
    with pytest.raises(CannotSend, match="without a name"):
        gather(lambda x: x, namespace=notebook.shell.user_ns, cells=notebook.cells)


def test_identifiers_are_compared_as_python_does_and_texts_stay_as_typed(notebook):
    notebook.run("ϕ = 2.0; ω0 = ϕ\ndef f(x):\n    '''ω² — ﬁ'''\n    return φ * x, 'max|ω²|', ω0")
    assert notebook.sent()(1) == (2.0, "max|ω²|", 2.0)
    assert "'''ω² — ﬁ'''" in notebook.gather("f").source


def test_a_label_with_a_backslash_does_not_warn(notebook):
    notebook.run("import warnings\nwarnings.simplefilter('ignore')")
    notebook.run("def f():\n    return '$\\omega$'")
    assert "\\omega" in notebook.gather("f").source


def test_the_same_state_gives_the_same_text_however_often_cells_ran(notebook):
    cells = [
        "import numpy as np",
        "k = 3",
        "def g(x):\n    return k * x",
        "def f(x):\n    return g(x) + np.sin(x)",
    ]
    notebook.run(*cells)
    before = notebook.gather("f").sha256
    notebook.run(cells[3], "f(1)", cells[2], cells[0], "%%time\n" + cells[2])
    assert notebook.gather("f").sha256 == before


def test_no_cells_are_needed_for_what_python_remembers(notebook):
    notebook.run("def g(x):\n    return x", "def f(x):\n    return g(x) + 1")
    assert alone(gather(notebook["f"], namespace=notebook.shell.user_ns, cells=[]))["f"](1) == 2


def test_the_running_notebook_is_taken_by_default(notebook, monkeypatch):
    monkeypatch.setattr("IPython.get_ipython", lambda: notebook.shell)
    notebook.run(
        "def f(x):\n    return 2 * x", "from polhode.notebook.gather import gather\nbundle = gather(f)"
    )
    assert notebook["bundle"].source == "def f(x):\n    return 2 * x\n"
    assert "bundle = gather(f)" in as_text()


def as_text(cells=None):
    """The cells of the bundle, one below the other."""
    bundle = whole_notebook(cells)
    assert bundle.filename == "notebook.ipynb"
    return "\n\n".join(cell["source"] for cell in json.loads(bundle.source)["cells"]) + "\n"


def test_the_whole_notebook_in_the_order_of_last_runs():
    cells = ["", "a = 1", "b = [a]", "a = 1", "polhode.submit(f)", "1 / 0", "  ", "b = [a]"]
    assert as_text(cells) == "a = 1\n\npolhode.submit(f)\n\n1 / 0\n\nb = [a]\n"


def test_a_cell_that_builds_on_what_it_did_stays_as_often_as_it_ran():
    cells = [
        "import math",
        "k = 0.25",
        "k = k * 2",
        "k = k * 2",
        "xs = []",
        "xs.append(k)",
        "xs.append(k)",
        "y = math.pi",
        "y = math.pi",
    ]
    namespace = {}
    exec(as_text(cells), namespace)
    assert namespace["k"] == 1.0 and namespace["xs"] == [1.0, 1.0] and as_text(cells).count("math.pi") == 1


def test_the_whole_notebook_defines_variables_too(monkeypatch):
    main = types.ModuleType("__main__")
    main.__dict__.update(slope=2.0, settings={"g": 9.81}, later=..., none=None, f=lambda x: x)
    monkeypatch.setitem(sys.modules, "__main__", main)
    assert set(whole_notebook().names) == {"slope", "settings", "f"}


def test_the_whole_notebook_runs_where_magics_are_blanked():
    cells = [
        "%%time\na = 1",
        "%matplotlib inline\n!pip install \\\n  numpy\nif a:\n    %time b = 2\nfiles = !ls\nb?",
        "%%bash\nls $HOME (",
        "def broken(:",
        "%%capture out\nc = a + b",
        "%%html\n<b>",
    ]
    text = as_text(cells)
    assert "%matplotlib inline" in text and "# %%bash" in text and "# def broken(:" in text
    namespace = {}
    exec(python_of(text), namespace)
    assert (namespace["a"], namespace["b"], namespace["c"], namespace["files"]) == (1, 2, 3, None)


def test_the_whole_notebook_keeps_lines_that_only_look_like_magics():
    cells = ["%matplotlib inline\na = '''\n%kept\n'''", "%%time\nb = (7\n   % 4)"]
    namespace = {}
    text = as_text(cells)
    ast.parse(text)
    exec(python_of(text), namespace)
    assert (namespace["a"], namespace["b"]) == ("\n%kept\n", 3)
