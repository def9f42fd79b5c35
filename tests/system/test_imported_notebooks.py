"""A published notebook is imported, and submissions of it are graded in the sandbox by the published
cells.
"""

import contextlib
import json
import shutil
import subprocess
import sys
from dataclasses import replace

import pytest

from exercises.authoring.importing.assignment_file import Findings, assignment_file
from exercises.authoring.importing.importing import read_published
from polhode.judging.verdict import Verdict
from service.cli.__main__ import main
from service.grading.grade import grade
from service.grading.submission import Submission
from service.sandbox.isolation.select import choose
from service.sandbox.result import SystemFault
from service.sandbox.sandbox import Sandbox
from tests.support.assignments import change, known
from tests.support.course_notebook import FILE, LABELS
from tests.support.course_shape import (
    CHECKS,
    HIDDEN,
    SETUP,
    SOLUTIONS,
    bare,
    course_notebook,
    notebook,
    published,
    written,
)
from tests.support.isolation import BY_THE_HOST
from tests.support.kit import environment, installed


def imported_folder(folder, name, text):
    file = written(folder / "in", f"{name}.ipynb", text)
    made = read_published(file, folder / "course", {})
    home = folder / made.slug.replace("-", "_")
    written(home, file.name, text)
    written(home, "assignment.py", assignment_file(made, Findings()))
    return home


@pytest.fixture(scope="module")
def sums(tmp_path_factory):
    home = imported_folder(tmp_path_factory.mktemp("imported"), "small-sums", published())
    with known(home) as found:
        assert not found.invalid, found.invalid
        yield found.valid["small-sums"]


def report(assignment, sandbox, text):
    return grade(Submission(text, "mine.ipynb"), assignment, sandbox, 1).report


def marks(report):
    return "".join(outcome.verdict.value[0] for outcome in report.outcomes())


def test_notebook_2_6_as_published_and_filled_in_prints_its_nine_lines(tmp_path, sandbox):
    with known(imported_folder(tmp_path, "rigid-rotation", course_notebook())) as found:
        made = report(found.valid["rigid-rotation"], sandbox, FILE.read_text())
    assert [outcome.label for outcome in made.outcomes()] == list(LABELS) and marks(made) == "p" * 9
    assert [outcome.line for outcome in made.outcomes()] == made.lines().split("\n")
    assert all(o.self_reported and not o.counted and o.points == o.earned == 0 for o in made.outcomes())
    assert "0 of 0 points (public checks: 0 of 0); 9 of 9 self-reported lines ✓" in made.text()
    assert not made.passed, "no check has points"


def test_filled_in_every_line_is_judged(sums, sandbox):
    made = report(sums, sandbox, published(SOLUTIONS))
    assert marks(made) == "ppppp"
    assert [o.detail for o in made.outcomes()][:2] == [
        "got 20 vs expected 20 (rtol=1e-06, atol=1e-09)",
        "sum 10",
    ]
    assert made.outcomes()[2].label == "2 to the power 3"  # the last of four
    assert (
        made.outcomes()[2].tolerance.rtol == 1e-12 and "self-reported" in made.outcomes()[2].tolerance.reason
    )


def test_the_first_wrong_of_several_claims_of_one_line_is_shown(sums, sandbox):
    made = report(sums, sandbox, published((SOLUTIONS[0], "powers = [1, 2, 5, 9]\n", SOLUTIONS[2])))
    assert marks(made) == "ppfpp" and made.outcomes()[2].label == "2 to the power 2"


def test_as_downloaded_nothing_is_measured(sums, sandbox):
    made = report(sums, sandbox, published())
    assert marks(made) == "uuuuu"
    missing = "name 'total' is not defined: define it in exercise 1, above its validation"
    assert missing in made.outcomes()[0].cause


def test_each_emptied_cell_says_which_names_are_read_below_it(sums):
    cells = [cell for cell in json.loads(sums.notebook())["cells"] if cell["cell_type"] == "code"]
    emptied = ["".join(cell["source"]) for cell in cells if "solution" in cell["metadata"].get("tags", ())]
    assert emptied == [f"# your code here\n# {name} = ..." for name in ("total", "powers", "area")]


def test_a_cell_that_fails_leaves_its_own_lines(sums, sandbox):
    made = report(sums, sandbox, published((SOLUTIONS[0], "powers = 1 / 0\n", SOLUTIONS[2])))
    assert marks(made) == "ppupp"
    assert "`powers` is missing because cell 4 stopped: ZeroDivisionError" in made.outcomes()[2].cause


def test_a_cell_that_never_ends_costs_no_other(sums, sandbox):
    made = report(
        replace(sums, load_s=0.3), sandbox, published((SOLUTIONS[0], "while True: pass\n", SOLUTIONS[2]))
    )
    assert marks(made) == "ppupp"


WRONG = ("total = 11\n", *SOLUTIONS[1:])
PASSING = (
    'validate.close(20, 20, "twice the sum is 20")\nvalidate.check(True, "the sum is positive", "sure")\n'
)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (published(WRONG, checks=(PASSING, *CHECKS[1:])), "fpppp"),  # the validation cell edited
        (published(WRONG, checks=(None, None, None)), "fpppp"),  # or deleted
        (published(WRONG, setup=SETUP.replace("2 * x", "20")), "fpppp"),  # Setup edited
        (published(WRONG, setup="import numpy as np\n"), "fpppp"),
        (published(("total = 11\nvalidate.close = lambda *a, **k: True\n", *SOLUTIONS[1:])), "fpppp"),
        (
            published(
                (
                    "total = 11\nimport polhode.judging.comparisons\n"
                    "polhode.judging.comparisons.close = None\nvalidate = None\n",
                    *SOLUTIONS[1:],
                )
            ),
            "fpppp",
        ),
        (
            published((f"total = 11\n{PASSING}", *SOLUTIONS[1:])),
            "fpppp",
        ),  # the same lines from the student's own cell
        (
            published(("total = 11\ndef double(x): return 20\n", *SOLUTIONS[1:])),
            "ppppp",
        ),  # redefines an instrument: self-reported
        (
            published((HIDDEN, *SOLUTIONS[1:]), checks=(f"total = 10\n{CHECKS[0]}", *CHECKS[1:])),
            "ppppp",
        ),  # solved in that cell
        (published(("import os\nos._exit(0)\n", *SOLUTIONS[1:])), "uuppp"),  # left out
    ],
)
def test_an_edited_copy_changes_no_line_but_by_its_numbers(sums, sandbox, text, expected):
    assert marks(report(sums, sandbox, text)) == expected


def test_cells_without_ids_as_the_kit_sends_them_and_a_python_file(sums, sandbox):
    cells = [SETUP, SOLUTIONS[0], CHECKS[0], "x = 3\n", SOLUTIONS[1], CHECKS[1], SOLUTIONS[2], CHECKS[2]]
    bare = "".join(cells)
    assert marks(grade(Submission(bare, "mine.py"), sums, sandbox, 1).report) == "ppppp"


def test_a_truth_or_trust_makes_a_line_count(tmp_path, sandbox):
    home = imported_folder(tmp_path, "strong-sums", published())
    text = (home / "assignment.py").read_text()
    text = text.replace('line("twice the sum is 20")', 'line("twice the sum is 20", truth=20, points=3)')
    text = text.replace('line("the area is positive")', 'line("the area is positive", trust=True)')
    text = text.replace('line("the series is near π")', 'line("the series is near π", truth=lambda: 3.0)')
    (home / "assignment.py").write_text(text)
    with known(home) as found:
        made = report(found.valid["strong-sums"], sandbox, published(SOLUTIONS))
        assert found.valid["strong-sums"].max_points() == 5
        again = report(
            found.valid["strong-sums"],
            sandbox,
            published(SOLUTIONS, checks=('validate.close(20, 20, "x")\n', *CHECKS[1:])),
        )
    assert marks(made) == "pppfp" and (made.score, made.max_score) == (4, 5)
    assert marks(again) == "pppfp"
    assert {o.verdict for o in made.outcomes() if o.self_reported} == {Verdict.PASS}


def test_a_students_own_checks_are_reported_wherever_validate_was_imported(tmp_path, sandbox):
    cells = [("code", "a", [], SETUP), ("code", "b", ["solution"], HIDDEN), ("code", "c", [], IMPORTS)]
    own = "total = 10\nvalidate.check(total > 1, 'mine')\n"
    with known(imported_folder(tmp_path, "own-lines", notebook(*cells))) as found:
        made = report(
            found.valid["own-lines"], sandbox, bare(SETUP, own, IMPORTS, own.replace("mine", "again"))
        )
    assert marks(made) == "p" and [check.label for check in made.notebook_checks] == ["mine", "again"]


REUSED = (
    'validate.close(x, 1.0, "x is one")\n',
    'validate.close(x, 2.0, "x is two")\n',
    'validate.check(y > 0, "y is positive")\n',
)
ONE, TWO, THREE = "x = np.ones(3)\n", "x = np.full(3, 2.0)\n", "y = 1\n"


@pytest.fixture(scope="module")
def reused(tmp_path_factory):
    """Exercise 2 gives the variable of exercise 1 another value."""
    home = imported_folder(tmp_path_factory.mktemp("reused"), "reused-x", published(checks=REUSED))
    with known(home) as found:
        yield found.valid["reused-x"]


MARKED = "".join(f"# %%\n{cell}\n" for cell in (SETUP, ONE, REUSED[0], TWO, REUSED[1], THREE, REUSED[2]))


@pytest.mark.parametrize(
    ("text", "name"),
    [
        (
            bare(SETUP, TWO, REUSED[1], ONE, REUSED[0], THREE, REUSED[2]),
            "mine.ipynb",
        ),  # exercises in another order
        (bare(SETUP, ONE, REUSED[0], TWO, REUSED[1], THREE, REUSED[2], SETUP), "mine.ipynb"),
        (
            bare(ONE, REUSED[0], TWO, REUSED[1], THREE, REUSED[2], SETUP),
            "mine.ipynb",
        ),  # Setup ran again after all others
        (
            bare(SETUP, REUSED[0], ONE, REUSED[0], TWO, REUSED[1], THREE, REUSED[2]),
            "mine.ipynb",
        ),  # a cell twice
        (bare(SETUP, ONE + REUSED[0] + TWO, REUSED[1], THREE, REUSED[2]), "mine.ipynb"),  # cells merged
        (bare("".join([SETUP, ONE, REUSED[0], TWO, REUSED[1], THREE, REUSED[2]])), "mine.ipynb"),
        ("".join([SETUP, ONE, REUSED[0], TWO, REUSED[1], THREE, REUSED[2]]), "mine.py"),
        (MARKED, "mine.py"),  # jupytext
        (MARKED.replace("is one", "is One"), "mine.py"),  # with an edited copy
        (published((ONE, TWO, THREE), checks=(None, *REUSED[1:])), "mine.ipynb"),  # a validation cell deleted
    ],
)
def test_each_line_sees_the_values_of_its_own_exercise(reused, sandbox, text, name):
    assert marks(grade(Submission(text, name), reused, sandbox, 1).report) == "ppp"


def test_equal_validation_cells_belong_to_their_own_exercises(tmp_path, sandbox):
    checks = ('validate.close(x, y, "the numbers agree")\n',) * 3
    with known(imported_folder(tmp_path, "equal-cells", published(checks=checks))) as found:
        wrong = ("x, y = 1, 2\n", "x, y = 2, 2\n", "x, y = 3, 3\n")
        assert marks(report(found.valid["equal-cells"], sandbox, published(wrong, checks=checks))) == "fpp"
        without_ids = bare(SETUP, *[cell for pair in zip(wrong, checks, strict=True) for cell in pair])
        assert marks(report(found.valid["equal-cells"], sandbox, without_ids)) == "fpp"


def test_a_cell_of_comments_that_is_not_tagged_is_the_students(tmp_path, sandbox):
    cells = [("code", "a", [], SETUP), ("code", "b", [], HIDDEN), ("code", "c", [], REUSED[0])]
    with known(imported_folder(tmp_path, "no-tags", notebook(*cells))) as found:
        assert marks(report(found.valid["no-tags"], sandbox, bare(SETUP, ONE, REUSED[0]))) == "p"


def test_own_checks_do_not_use_up_those_of_the_published_cells(sums, sandbox):
    own = "for k in range(99):\n    validate.check(True, 'mine')\n"
    made = report(sums, sandbox, published((SOLUTIONS[0], f"powers = [1, 2, 4, 9]\n{own}", SOLUTIONS[2])))
    assert marks(made) == "ppfpp" and len(made.notebook_checks) == 99
    many = "powers = [2.0**n for n in range({})]\n"
    assert marks(report(sums, sandbox, published((SOLUTIONS[0], many.format(200), SOLUTIONS[2])))) == "ppppp"
    made = report(sums, sandbox, published((SOLUTIONS[0], "powers = [1] + [1.0] * 1500\n", SOLUTIONS[2])))
    assert marks(made) == "ppfpp"
    made = report(
        sums,
        sandbox,
        published((SOLUTIONS[0], "powers = [2.0**(n % 1000) for n in range(1001)]\n", SOLUTIONS[2])),
    )
    assert marks(made) == "ppupp" and "more than 1000 checks of one line" in made.outcomes()[2].cause


def test_a_loop_that_stops_early_proves_nothing(sums, sandbox):
    powers = "def powers():\n    yield 1\n    1 / 0\npowers = powers()\n"
    made = report(sums, sandbox, published((SOLUTIONS[0], powers, SOLUTIONS[2])))
    assert marks(made) == "ppupp" and "ZeroDivisionError" in made.outcomes()[2].cause


@pytest.mark.parametrize(
    ("powers", "mark"),
    [
        ("[2**n for n in range(4)]", "p"),
        ("[2**n for n in range(9)]", "p"),
        ("[1]", "u"),
        ("[]", "u"),
        ("[1, 3]", "f"),
    ],
)
def test_a_loop_makes_the_claims_that_it_makes_with_the_authors_solution(tmp_path, sandbox, powers, mark):
    home = imported_folder(tmp_path, "looped-sums", published())
    written(home / "samples", "right_all.ipynb", published(SOLUTIONS))
    with known(home) as found:
        made = report(
            found.valid["looped-sums"],
            sandbox,
            published((SOLUTIONS[0], f"powers = {powers}\n", SOLUTIONS[2])),
        )
    assert marks(made) == f"pp{mark}pp", made.text()
    if powers == "[1]":
        assert "the loop made 1 of the 4 checks that it makes with the right solution" in made.text()


IMPORTS = 'from ecp import validate\nvalidate.close(total, 10, "ten")\n'
PATCHES = (
    (
        "import ecp.validate as w\nold = w.close\n"
        "w.close = lambda got, expected, *a, **k: old(expected, expected, *a, **k)\n"
    ),
    (
        "import ecp, types\nv = ecp.validate\n"
        "ecp.validate = types.SimpleNamespace(close=lambda g, e, label: v.close(e, e, label))\n"
    ),
    "import sys\nsys._getframe = None\n",
    "import sys\nsys.modules['ecp'] = None\n",
)


@pytest.mark.parametrize("patch", PATCHES)
def test_a_published_cell_that_imports_validate_gets_the_kits(tmp_path, sandbox, patch):
    checks = (IMPORTS, *CHECKS[1:])
    with known(imported_folder(tmp_path, "imports-it", published(checks=checks))) as found:
        made = report(
            found.valid["imports-it"],
            sandbox,
            published((f"total = 11\n{patch}", *SOLUTIONS[1:]), checks=checks),
        )
    assert marks(made) == "fppp"


LENGTHS = (
    'validate.close(np.linalg.norm(v), 5.0, "the length is 5")\n',
    'for k in range(3):\n    validate.close(powers[k], 2**k, f"power {k}")\n',
    'import math\nvalidate.close(math.hypot(*v), 5.0, "the same length")\n',
)
WRONG_LENGTHS = "v = np.ones(2)\npowers = [1, 0, 0]\n"
REPLACED = {
    "an attribute": "np.linalg.norm = lambda v: 5.0\nimport math\nmath.hypot = lambda *v: 5.0\n",
    "a name of a builtin": "range = lambda n: [0]\n",
    "a builtin": "import builtins\nbuiltins.range = lambda n: [0]\n",
    "the builtins": "__builtins__ = {**vars(__import__('builtins')), 'range': lambda n: [0]}\n",
    "a module": (
        "import types\nnp.linalg = types.SimpleNamespace(norm=lambda v: 5.0)\n"
        "import sys\nsys.modules['math'] = types.SimpleNamespace(hypot=lambda *v: 5.0)\n"
    ),
    "the name of a module": (
        "import types\nones = np.ones\n"
        "np = types.SimpleNamespace(linalg=types.SimpleNamespace(norm=lambda v: 5.0), ones=ones)\n"
    ),
    "code": (
        "def norm(x, ord=None, axis=None, keepdims=False): return 5.0\n"
        "np.linalg.norm._implementation.__code__ = norm.__code__\n"
    ),
    "what a function of numpy calls": "import numpy.linalg._linalg as inner\ninner.sqrt = lambda x: 5.0\n",
    "the class of a module": (
        "import types\nclass Module(types.ModuleType):\n"
        "    def __getattribute__(self, name):\n"
        "        return (lambda v: 5.0) if name == 'norm' else super().__getattribute__(name)\n"
        "np.linalg.__class__ = Module\n"
    ),
    "all that is deleted": "del np.linalg.norm\n",
    "the tree of a cell": (
        "import ast\nclass Five(ast.NodeTransformer):\n    def visit_Call(self, node):\n"
        "        self.generic_visit(node)\n        name = ast.unparse(node.func)\n"
        "        return ast.Constant(5.0) if name in ('np.linalg.norm', 'math.hypot') else node\n"
        "try:\n    get_ipython().ast_transformers.append(Five())\nexcept Exception:\n    pass\n"
        "parse = ast.parse\nast.parse = lambda *a, **k: Five().visit(parse(*a, **k))\n"
    ),
    "the text of a cell": (
        "try:\n    get_ipython().input_transformers_post.append(\n"
        "        lambda lines: [line.replace('np.linalg.norm(v)', '5.0') for line in lines])\n"
        "except Exception:\n    pass\n"
    ),
    "what runs between lines": (
        "import math, sys\nowners, lie = [(np.linalg, 'norm'), (math, 'hypot')], lambda *v: 5.0\n"
        "true = [getattr(*one) for one in owners]\n"
        "def trace(frame, event, argument):\n"
        "    if frame.f_code.co_filename.startswith('published'):\n"
        "        for one, value in zip(owners, true):\n"
        "            setattr(*one, value if event == 'return' else lie)\n"
        "    return trace\nsys.settrace(trace)\nrange = lambda n: [0]\n"
    ),
}


@pytest.fixture(scope="module")
def lengths(tmp_path_factory):
    home = imported_folder(tmp_path_factory.mktemp("lengths"), "lengths", published(checks=LENGTHS))
    with known(home) as found:
        yield found.valid["lengths"]


def lengths_of(*solution):
    return published((solution[0], *solution[1:], *[HIDDEN] * (3 - len(solution))), checks=LENGTHS)


def test_right_lengths_are_right(lengths, sandbox):
    right = "v = np.array([3.0, 4.0])\npowers = [1, 2, 4]\nsum = max = range = id = input = 0\n"
    assert marks(report(lengths, sandbox, lengths_of(right))) == "ppp"


@pytest.mark.parametrize("name", REPLACED)
@BY_THE_HOST
def test_given_cells_run_with_modules_and_builtins_as_they_were(lengths, either_sandbox, name):
    made = report(lengths, either_sandbox, lengths_of(f"{REPLACED[name]}{WRONG_LENGTHS}"))
    assert marks(made) == "fff", made.text()


def test_a_given_cell_knows_that_it_is_the_main_program_of_a_notebook(tmp_path, sandbox):
    checks = ('validate.check(__name__ == "__main__", "main")\nget_ipython()\n', *LENGTHS[1:])
    with known(imported_folder(tmp_path, "main-lines", published(checks=checks))) as found:
        right = "v = np.array([3.0, 4.0])\npowers = [1, 2, 4]\n"
        made = report(found.valid["main-lines"], sandbox, published((right, HIDDEN, HIDDEN), checks=checks))
    assert marks(made) == "ppp", made.text()


def test_the_submission_finds_its_own_changes_again(lengths, sandbox):
    changes = "v = np.array([3.0, 4.0])\npowers = [1, 2, 4]\nnp.linalg.norm = lambda v: 7.0\nrange = 5\n"
    finds = "print(np.linalg.norm(v), range)\n"
    made = report(lengths, sandbox, lengths_of(changes, finds))
    assert (marks(made) == "ppp" and made.stdout.startswith("7.0 5\n")) or "7.0 5\n" in made.stdout


def test_what_the_submission_changes_while_a_given_cell_runs_makes_its_lines_unmeasured(lengths, sandbox):
    changes = (
        "class Vector:\n    def __array__(self, *a, **k):\n        np.linalg.norm = lambda v: 5.0\n"
        "        return np.ones(2)\n    def __iter__(self):\n        return iter((3.0, 4.0))\n"
        "v, powers = Vector(), [1, 2, 4]\n"
    )
    made = report(lengths, sandbox, lengths_of(changes))
    assert marks(made) == "upp", made.text()
    assert "your code changed numpy.linalg.norm while the cell ran" in made.outcomes()[0].line


FORGED = (
    "class Forged:\n    def __array__(self, *a, **k):\n        {}\n        raise SystemExit\n"
    "total = Forged()\ndouble = lambda x: x\n"
)


@pytest.mark.parametrize(
    ("solution", "mark"),
    [
        ("total = []\n", "u"),
        (FORGED.format("validate.check(True, 'forged')"), "u"),
        (FORGED.format("validate.close(1.0, 1.0, 'forged', rtol=float('inf'))"), "u"),
        ("total = np.full(3, np.inf)\n", "f"),
    ],
)
def test_only_the_published_call_with_its_own_tolerance_earns_points(tmp_path, sandbox, solution, mark):
    checks = ('validate.close(total, 10, "ten")\n', *CHECKS[1:])
    home = imported_folder(tmp_path, "pointed", published(checks=checks))
    text = (home / "assignment.py").read_text().replace('line("ten")', 'line("ten", truth=10, points=3)')
    (home / "assignment.py").write_text(text)
    with known(home) as found:
        made = report(found.valid["pointed"], sandbox, published((solution, *SOLUTIONS[1:]), checks=checks))
    first = made.outcomes()[0]
    assert (first.verdict.value[0], first.label, first.earned) == (mark, "ten", 0)


STRENGTHENED = """
from exercises.authoring import between, relative

ROUNDING = relative(1e-12, because="a thousand rounding errors")


@notebook.exercise("1", "Areas")
def areas(ask):
    disc = ask.function("disc")
    disc.case("any disc", r=between(1, 2))
    disc.truth(lambda r: 3.141592653589793 * r * r, agree=ROUNDING)
    disc.mistake("wrong-function", "this is the circumference", change="np.pi * r**2 -> 2 * np.pi * r")
    ask.line("the disc of radius 3", trust=True)


@notebook.exercise("2", "Rings")
def rings(ask):
    ring = ask.function("ring")
    ring.case("any ring", a=between(1, 2), b=between(3, 4))
    ring.truth(lambda a, b: 3.141592653589793 * (b - a) * (b + a), agree=ROUNDING)
    ring.mistake("missing-term", "the hole is missing", change="disc(b) - disc(a) -> disc(b)")
"""
DISC, RING = "def disc(r):\n    return np.pi * r**2\n", "def ring(a, b):\n    return disc(b) - disc(a)\n"
DISC_LINE = 'validate.close(disc(3.0), 9 * np.pi, "the disc of radius 3")\n'


def of_rings(disc=HIDDEN, ring=HIDDEN):
    return notebook(
        ("markdown", "setup-text", [], "## Setup"),
        ("code", "setup", [], SETUP),
        ("code", "disc", ["solution"], disc),
        ("code", "disc-lines", ["validation"], DISC_LINE),
        ("code", "ring", ["solution"], ring),
    )


@pytest.fixture(scope="module")
def rings(tmp_path_factory):
    """An imported notebook with two questions, one of which uses the function of the other; both use the
    published Setup.
    """
    home = imported_folder(tmp_path_factory.mktemp("rings"), "rings", of_rings(DISC, RING))
    head, _, _ = (home / "assignment.py").read_text().partition("\n\n@notebook.exercise(")
    text = head + STRENGTHENED
    (home / "assignment.py").write_text(text)
    with known(home) as found:
        assert not found.invalid, found.invalid
        yield found.valid["rings"]


def test_a_question_of_an_imported_notebook_is_diagnosed(rings, sandbox):
    made = report(rings, sandbox, of_rings("def disc(r):\n    return 2 * np.pi * r\n", RING))
    assert marks(made) == "fffpp"
    assert [{d.sentence for d in o.diagnosis} for o in made.outcomes()[:2]] == [
        {"this is the circumference"}
    ] * 2


def test_a_chain_of_an_imported_notebook_uses_the_reference(rings, sandbox):
    made = report(rings, sandbox, of_rings("def disc(r):\n    return 2 * np.pi * r\n", RING))
    assert made.provenance.chains == {"2": "the reference disc"}


def test_a_line_of_an_imported_notebook_does_not_keep_a_chain_from_its_own_function(rings, sandbox):
    """The line fails, because the published cell calls the function with a number that the student did not
    foresee.
    """
    one = "def disc(r):\n    if r == 3.0:\n        raise ValueError\n    return np.pi * r**2\n"
    made = report(rings, sandbox, of_rings(one, "def ring(a, b):\n    return disc(b)\n"))
    assert marks(made) == "ppuff" and made.provenance.chains == {"2": "the submission's disc"}


@pytest.mark.slow
def test_verify_of_an_imported_notebook_names_no_line_as_untested(rings, capsys):
    assert main(["verify", "rings", "--seeds", "1", "--jobs", "1"]) == 0
    assert "warning" not in capsys.readouterr().out


COURSE = {
    "__init__.py": "from . import draw, shapes, validate\n",
    "validate.py": "def check(ok, label, strict=True):\n    print('✓' if ok else '✗', '', label)\n",
    "shapes.py": (
        "import numpy as np\n\nfrom . import draw\nfrom .rounding import digits\n\n\n"
        "def side(area):\n    return digits(np.sqrt(area)), draw.PEN\n"
    ),
    "rounding.py": "def digits(x):\n    return round(float(x), 3)\n",
    "draw.py": "PEN = 'blue'\n",
    "unused.py": "1 / 0\n",
}
IMPORTS_OWN = "from lab import draw, shapes, validate\n"
OWN_LINE = 'validate.check(shapes.side(total) == (3.162, "blue") == (3.162, draw.PEN), "a side of 3.162")\n'
KERNEL = """
import sys
sys.path.insert(0, "kit")
import polhode
polhode.connect(assignment="own-modules")
from lab import draw, shapes
assert shapes.side(10) == (3.162, "blue") and draw.PEN == "blue"
import os
assert sorted(os.listdir()) == ["cache", "kit"], os.listdir()
"""


def test_a_notebook_imports_the_package_of_its_course_in_the_sandbox_and_with_the_kit(tmp_path, capsys):
    for name, source in COURSE.items():
        written(tmp_path / "lab", name, source)
    cells = [
        ("code", "a", [], IMPORTS_OWN),
        ("code", "b", ["solution"], HIDDEN),
        ("code", "c", ["validation"], OWN_LINE),
    ]
    file = written(tmp_path, "own-modules.ipynb", notebook(*cells))
    into = tmp_path / "into"
    with known():
        assert main(["import-notebook", str(file), "--into", str(into)]) == 0
    assert "lab is not installed on this machine" in capsys.readouterr().out
    shutil.rmtree(into)
    with known():
        command = ["import-notebook", str(file), "--into", str(into), "--package", str(tmp_path / "lab")]
        assert main(command) == 0
    assert "not installed" not in capsys.readouterr().out
    assert {path.name for path in (into / "course" / "lab").iterdir()} == COURSE.keys()
    solved = notebook(cells[0], ("code", "b", ["solution"], "total = 10\n"), cells[2])
    with known(into) as found, contextlib.closing(Sandbox(choose("namespaces"))) as own:
        made = report(found.valid["own-modules"], own, solved)
        kit = installed(tmp_path / "there", "own-modules")
    assert marks(made) == "p", made.text()
    done = subprocess.run(
        [sys.executable, "-P", "-c", KERNEL],
        cwd=kit.parent,
        capture_output=True,
        text=True,
        check=False,
        env=environment(kit),
    )
    assert done.returncode == 0, done.stderr


def test_complex_numbers_are_compared(tmp_path, sandbox):
    lines = (
        'validate.close(state, [0.6, 0.8j], "the state")\n',
        'validate.close(energy, 2, "the energy is real")\n',
        'validate.conserved(norms, "the norm")\n',
    )
    home = imported_folder(tmp_path, "states", published(checks=lines))
    change(home / "assignment.py", 'line("the state")', 'line("the state", truth=(0.6, 0.8j))')
    right = (
        "state = [0.6 + 1e-12j, 0.8j]\n",
        "energy = np.array(2 + 0j)\n",
        "norms = np.array([1 + 0j, 1 + 0j])\n",
    )
    wrong = ("state = [0.6, -0.8j]\n", "energy = 2j\n", "norms = np.array([1 + 0j, 1j])\n")
    with known(home) as found:
        assignment = found.valid["states"]
        assert marks(report(assignment, sandbox, published(right, checks=lines))) == "ppp"
        made = report(assignment, sandbox, published(wrong, checks=lines))
    assert marks(made) == "fff" and "max relative drift = 1 (" in made.outcomes()[2].line


STRICT = (
    'validate.close(total, 10, "ten")\nok = validate.check(total > 0, "positive", f"sum {total}")\n',
    (
        'for n, x in enumerate(powers):\n    validate.close(x, 2**n, f"power {n}")\n'
        '    validate.check(x > 1, "above")\n'
    ),
    'try:\n    validate.check(area < 0, "negative")\nexcept AssertionError:\n    area = 3.0\n'
    'validate.close(area, 3.0, "three", strict=False)\n',
)
OWN = "total = 11\nvalidate.close(total, 10, 'mine')\nafter = 1\n"


def test_a_strict_cross_ends_its_statement_and_no_other_of_a_given_cell(tmp_path, sandbox):
    with known(imported_folder(tmp_path, "strict-lines", published(checks=STRICT))) as found:
        made = report(
            found.valid["strict-lines"],
            sandbox,
            published((OWN, "powers = [1, 2]\n", "area = 1.0\n"), checks=STRICT),
        )
    assert [outcome.line for outcome in made.outcomes()] == [
        "✗  ten   [got 11 vs expected 10 (rtol=1e-06, atol=1e-09)]",
        "✓  positive   [sum 11]",
        "–  power {n}   [not measured: another line of its loop is ✗, which ends the loop]",
        "✗  above",
        "✗  negative",
        "✓  three   [got 3 vs expected 3 (rtol=1e-06, atol=1e-09)]",
    ]
    assert [check.line for check in made.notebook_checks] == [
        "✗  mine   [got 11 vs expected 10 (rtol=1e-06, atol=1e-09)]"
    ]
    assert made.scene_ends == [], "the line says it"


@pytest.mark.parametrize(
    "patch",
    [
        "import builtins\nbuiltins.print = lambda *a, **k: None\n",
        "print = lambda *a, **k: None\n",
        "import sys\nsys.stdout = None\n",
        "import ecp.validate as v\nv.check = lambda *a, **k: True\n",
        "import ecp.validate as v\nv.close.__wrapped__.__code__ = (lambda *a, **k: True).__code__\n",
        "import numpy as n\nn.asarray = lambda *a, **k: n.zeros(1)\nn.allclose = lambda *a, **k: True\n",
    ],
)
def test_what_a_submission_patches_changes_only_its_own_lines(sums, sandbox, patch):
    made = report(sums, sandbox, published((f"total = 11\n{patch}", *SOLUTIONS[1:])))
    assert [outcome.line for outcome in made.outcomes()][:2] == [
        "✗  twice the sum is 20   [got 22 vs expected 20 (rtol=1e-06, atol=1e-09)]",
        "✓  the sum is positive   [sum 11]",
    ]


def test_a_large_field_is_judged_with_the_truth(tmp_path, sandbox):
    checks = ('validate.close(field, field, "field")\n', 'validate.close(field, 0.0, "zero")\n', "x = 1\n")
    home = imported_folder(tmp_path, "fields", published(checks=checks))
    change(home / "assignment.py", 'line("field")', 'line("field", truth=1.0)')
    field = "field = np.ones((3, 400_000))\n"
    solution = ("", f"{field}field[2, -1] += 1e-3\n", HIDDEN)
    with known(home) as found:
        made = report(found.valid["fields"], sandbox, published((field, *solution[1:]), checks=checks))
        wrong = report(found.valid["fields"], sandbox, published((solution[1], *solution[1:]), checks=checks))
    tolerance = "(rtol=1e-06, atol=1e-09)]"
    assert [outcome.line for outcome in made.outcomes()] == [
        f"✓  field   [max|Δ| = 0 {tolerance}",
        f"✗  zero   [max|Δ| = 1.001 {tolerance}",
    ]
    assert wrong.outcomes()[0].line == f"✗  field   [max|Δ| = 0.001 {tolerance}"


def test_a_broken_course_package_is_a_system_fault(tmp_path, sandbox_of_this_course):
    folder, play = sandbox_of_this_course
    written(folder / "lab", "validate.py", "x = 1\n1 / 0\n")
    with pytest.raises(SystemFault, match=r"course/lab/validate.py, line 2: ZeroDivisionError"):
        play()


@pytest.fixture
def sandbox_of_this_course(tmp_path):
    """A folder of a course, and a function that grades a notebook which imports its package ``lab``."""
    home = imported_folder(
        tmp_path, "own-lab", notebook(("code", "a", ["validation"], f"from lab import validate\n{REUSED[0]}"))
    )
    written(tmp_path / "course" / "lab", "__init__.py", "")

    def play():
        with known(home) as found, contextlib.closing(Sandbox(choose("namespaces"))) as own:
            return report(found.valid["own-lab"], own, bare("x = 1.0\n"))

    return tmp_path / "course", play
