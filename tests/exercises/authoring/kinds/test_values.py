"""Values of functions at points: in the sandbox, and the same lines in the students' kit."""

import json
import sys

import numpy as np
import pytest

from exercises.authoring.draws import array_of, between, integer
from exercises.authoring.kinds.values import values
from exercises.authoring.questions.author_arguments import Value
from polhode.judging.author_errors import AuthorError
from polhode.judging.outcome import Tolerance
from polhode.judging.verdict import RowsRight, Verdict
from polhode.kinds.values import agreement, credited
from service.grading.grade import grade
from service.grading.submission import Submission
from tests.support.assignments import known
from tests.support.author_notebooks import declared
from tests.support.solutions import solution
from tests.support.toolbox import check_locally, failed, judged, mistaken, question_of, right


@pytest.mark.parametrize("seed", [1, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (2, 3, 4))])
def test_the_right_solutions_pass_with_every_seed(toolbox, sandbox, seed):
    report = grade(Submission(right(toolbox)), toolbox.assignment, sandbox, seed).report
    assert report.passed, report.text()


@pytest.mark.parametrize(
    ("function", "number", "ids"),
    [
        ("find_root", 0, ["1-value"]),
        ("find_root", 1, ["1-value"]),
        ("find_root", 2, ["1-calls"]),
        ("normal_modes", 0, ["2-omega"]),
        ("normal_modes", 1, ["2-omega", "2-X"]),
        ("normal_modes", 2, ["2-X"]),
        ("Pendulum", 0, ["3-value"]),
    ],
)
def test_a_mistake_fails_its_checks_with_public_and_with_new_inputs(toolbox, sandbox, function, number, ids):
    report = grade(Submission(mistaken(toolbox, function, number)), toolbox.assignment, sandbox, 1).report
    found = {outcome.id for outcome in report.outcomes() if outcome.verdict is Verdict.FAIL}
    assert found == {id for name in ids for id in (name, name.replace("-", "-new-"))}


@pytest.mark.parametrize(
    ("source", "sentence"),
    [
        ("def find_root(f, a, b, tol): f(a)", "find_root returned None"),
        (
            "def find_root(f, a, b, tol): return [1.0, 2.0]",
            "find_root must return a number; it returned shape (2,)",
        ),
        ("def find_root(f, a, b, tol): return float('nan')", "find_root returned a value that is not finite"),
        ("def find_root(f, a): return 1.0", "the checks call `find_root(f, a, b, tol)`"),
        ("def find_root(f, a, b, tol):\n    while True: f(a)", "it called f more than 600 times"),
        (
            "def normal_modes(M, K): return 1.0",
            "normal_modes must return 2 values (omega, X); it returned a float",
        ),
        (
            "def normal_modes(M, K): return M",
            "normal_modes must return 2 values (omega, X); it returned 3 values",
        ),
        (
            "def normal_modes(M, K):\n    M[0, 0] = 0\n    return M[0], M",
            "normal_modes changes its argument M",
        ),
        ("def normal_modes(M, K): return np.ones((3, 1)), 1", "normal_modes (omega) must return shape (3,)"),
    ],
)
def test_a_wrong_answer_is_unmeasured_with_its_reason(toolbox, sandbox, source, sentence):
    report = grade(Submission(source), toolbox.assignment, sandbox, 1).report
    assert {outcome.verdict for outcome in report.outcomes()} == {Verdict.UNMEASURED}
    assert all(sentence in outcome.line for outcome in report.outcomes()), report.text()


def modes(returned):
    return f"""
from fractions import Fraction

import numpy as np
import scipy.linalg

def normal_modes(M, K):
    squares, X = scipy.linalg.eigh(K, M)
    omega = np.sqrt(squares)
    return {returned}
"""


@pytest.mark.parametrize(
    ("returned", "absent", "sentence"),
    [
        ("omega[:2], X", "omega", "normal_modes (omega) must return shape (3,); it returned shape (2,)"),
        ("omega, None", "X", "normal_modes (X) returned None: is a return statement missing?"),
        (
            "[Fraction(w) for w in omega], X",
            "omega",
            "it returned Fractions: convert each with float(x)",
        ),
        ("omega, X.astype(str)", "X", "normal_modes (X) must return real numbers"),
    ],
)
def test_a_part_of_the_wrong_kind_does_not_hide_the_others(toolbox, sandbox, returned, absent, sentence):
    report = grade(Submission(modes(returned)), toolbox.assignment, sandbox, 1).report
    assert len(report.outcomes()) == 4
    for outcome in report.outcomes():
        if outcome.id.endswith(absent):
            assert outcome.verdict is Verdict.UNMEASURED and sentence in outcome.line, outcome.line
            assert [d.code for d in outcome.diagnosis] in (["wrong-shape"], ["returns-nothing"])
        else:
            assert outcome.verdict is Verdict.PASS, outcome.line


WRAPPED = """
def overwriting(function):
    places = {}

    def kept(place, answer):
        if isinstance(answer, tuple):
            return tuple(kept((*place, k), part) for k, part in enumerate(answer))
        if not isinstance(answer, np.ndarray):
            return answer
        buffer = places.setdefault((place, answer.shape), np.empty_like(answer))
        buffer[...] = answer
        return buffer

    @functools.wraps(function)
    def same(*values, **named):
        return kept((), function(*values, **named))

    return same


def boxed(function):
    def box(answer):
        if isinstance(answer, tuple):
            return tuple(map(box, answer))
        return np.array([[answer]]) if isinstance(answer, float) else answer

    return functools.wraps(function)(lambda *values, **named: box(function(*values, **named)))
"""


@pytest.mark.parametrize("wrapper", ["overwriting", "boxed"])
def test_arrays_that_are_overwritten_and_arrays_of_one_number_are_accepted(toolbox, sandbox, wrapper):
    kinds = ("values", "ode", "stepper", "random", "fit")
    used = {
        name for q in toolbox.notebook.questions() for name in q.document.get("uses", ())
    }  # by their author
    asked = {q.function for q in toolbox.notebook.questions() if q.kind in kinds} - used
    lines = [f"if type({name}) is type(boxed):\n    {name} = {wrapper}({name})" for name in sorted(asked)]
    source = "\n".join([right(toolbox), "import functools", WRAPPED, *lines])
    report = grade(Submission(source), toolbox.assignment, sandbox, 1).report
    assert report.passed, report.text()
    assert any(outcome.remarks for outcome in report.outcomes())


@pytest.mark.slow
def test_a_part_of_the_wrong_kind_does_not_hide_the_others_in_the_kit(toolbox, tmp_path):
    lines = json.loads(check_locally("toolbox", modes("omega, 'X'"), tmp_path))
    marks = {line[0] for line in lines if "normal_modes" in line}
    assert marks == {"✓", "–"} and any(
        "normal_modes (X) must return real numbers" in line for line in lines
    ), lines


PARTLY = """
def find_root(f, a, b, tol):
    while b - a > tol:
        m = (a + b) / 2
        a, b = (m, b) if f(m) < 0 else (a, m)
    return a if a < 2 else a + 1e-3
"""


@pytest.mark.slow
def test_partial_credit_is_the_share_of_right_inputs_on_the_server_and_in_the_kit(toolbox, sandbox, tmp_path):
    report = grade(Submission(PARTLY), toolbox.assignment, sandbox, 1).report
    found = {outcome.id: outcome for outcome in report.outcomes()}
    public, hidden = found["1-value"], found["1-new-value"]
    assert (
        0 < public.partial.right < public.partial.rows == 3
        and 0 < hidden.partial.right < hidden.partial.rows == 16
    )
    for outcome in (public, hidden):
        right, rows = outcome.partial.right, outcome.partial.rows
        assert outcome.verdict is Verdict.FAIL and outcome.earned == 4 * right // rows
        assert outcome.notes()[-1] == f"{right} of {rows} inputs are right: {outcome.earned} of 4 points"
    assert report.score == public.earned + hidden.earned + 8 and report.max_score == 16
    of = "[outcome.line, outcome.earned, outcome.points, outcome.notes()], report.summary()"
    local, summaries = zip(*json.loads(check_locally("toolbox", PARTLY, tmp_path, f"[{of}]")), strict=True)
    assert (
        summaries[0].startswith(f"{public.earned + 4} of ") and "points of the public checks" in summaries[0]
    )
    assert list(local) == [[o.line, o.earned, o.points, o.notes()] for o in report.outcomes() if not o.hidden]


def test_a_row_is_right_for_partial_credit_if_the_whole_check_would_accept_it():
    """A limit is relative to the largest number of all rows, also for a row that is judged alone."""
    want, limit = np.array([1e-3, 1.0, 0.5]), {"tolerance": {"limit": 1e-3, "reason": "rounding"}}
    got = np.array([1.5e-3, 2.0, 0.5])
    found = credited({"partial": True}, lambda given: agreement(limit, given, want), got, want)
    assert (
        found.partial == RowsRight(2, 3)
        and credited({}, lambda given: agreement(limit, given, want), got, want).partial is None
    )


WRONG = [("normal_modes", 1), ("oscillator", 1), ("pendulum", 1), ("rk4_step", 1), ("verlet", 0)]


@pytest.mark.parametrize("wrong", [[], pytest.param(WRONG, marks=pytest.mark.slow)], ids=["right", "wrong"])
def test_the_kit_prints_the_lines_of_the_server(toolbox, sandbox, tmp_path, wrong):
    source = "\n\n".join(mistaken(toolbox, function, number) for function, number in wrong) or right(toolbox)
    report = grade(Submission(source), toolbox.assignment, sandbox, 1).report
    served = [outcome.line for outcome in report.outcomes() if not outcome.hidden]
    local = json.loads(check_locally("toolbox", source, tmp_path))
    unseeded = "end_point"  # draws other numbers each time
    assert [line for line in local if unseeded not in line] == [
        line for line in served if unseeded not in line
    ]


def test_a_function_argument_takes_its_arguments_by_name_and_no_others(toolbox):
    question = question_of(toolbox, "heun_step")
    by_name = (
        "def heun_step(f, t, y, h):\n    k = f(y=y, t=t)\n"
        "    return y + h / 2 * (k + f(t + h, y=y + h * k))\n"
    )
    assert failed(judged(question, by_name)) == set()
    for call in ("f(y)", "f(t, y, h)", "f(t, t=t)", "f(t, x=y)"):
        with pytest.raises(TypeError, match=r"the function takes \(t, y\)"):
            judged(question, f"def heun_step(f, t, y, h):\n    return {call}\n")


def test_several_values_may_come_in_one_array(toolbox):
    right_answer = question_of(toolbox, "verlet").solution
    assert (
        failed(
            judged(
                question_of(toolbox, "verlet"), lambda force, x, v, h: np.array(right_answer(force, x, v, h))
            )
        )
        == set()
    )


@pytest.mark.parametrize(
    "exact", [[[1.0, 2.0], [1e-9, 0.0]], [[0.0, 0.0], [0.0, 0.0]]], ids=["one row cancels", "all are zero"]
)
def test_rounding_errors_are_relative_to_the_largest_number(exact):
    limit = {"tolerance": {"limit": 1e-13, "reason": "rounding"}}
    want = np.array(exact)
    assert agreement(limit, want + 1e-16, want).verdict is Verdict.PASS
    assert agreement(limit, want + 1e-12, want).verdict is Verdict.FAIL


TYPES = """
import numpy as np
from exercises.authoring import Notebook, Value, absolute, array_of, between, integer, one_of

notebook = Notebook("notebook.ipynb")
exact = absolute(1e-12, because="rounding")
missing = one_of(np.array([1.0, np.nan]), np.array([2.0, 3.0]))


@notebook.exercise("1")
def types(ask):
    ask_for(ask, "third", lambda n: int(n / 3), n=integer(1, 99))
    ask_for(ask, "is_positive", lambda x: np.sign(x) == 1, x=array_of(4, between(-1, 1)))
    ask_for(ask, "roots", complex_roots, Value(exact, up_to="order"), b=between(0, 3))
    ask_for(ask, "length", lambda text: 3 if text == "abc" else 2, text=one_of("abc", "de"))
    ask_for(ask, "total", lambda x: 1.0 if x[0] == 1.0 else 5.0, x=missing)
    ask_for(ask, "count", lambda mask: np.count_nonzero(mask), mask=lambda rng: rng.random(5) < 0.5)


def ask_for(ask, function, truth, agree=exact, **given):
    asked = ask.function(function)
    asked.case("", **given)
    asked.truth(truth, agree=agree)


def complex_roots(b):
    return -b / 2 + np.array([1, -1]) * np.sqrt(b * b / 4 - 5 + 0j)
"""
OF_TYPES = """
def third(n):
    return n // 3
def is_positive(x):
    return x > 0
def roots(b):
    return np.roots([1.0, b, 5.0])
def length(text):
    return len(text)
def total(x):
    return np.nansum(x)
def count(mask):
    return mask.sum()
"""


def test_integers_booleans_complex_numbers_strings_and_missing_data(sandbox, tmp_path, monkeypatch):
    with known(declared(tmp_path / "types", TYPES, OF_TYPES)) as catalogue:
        assignment, notebook = catalogue.valid["types"], sys.modules["exercises.types.assignment"].notebook
        source = "\n\n".join(question.source for question in notebook.questions())
        report = grade(Submission(source), assignment, sandbox, 1).report
        assert report.passed and len(report.outcomes()) == 12, report.text()
        served = [outcome.line for outcome in report.outcomes() if not outcome.hidden]
        assert json.loads(check_locally("types", source, tmp_path)) == served
        wrong = grade(Submission("def is_positive(x): return x < 0.5"), assignment, sandbox, 1).report
        asked = [outcome for outcome in wrong.outcomes() if outcome.label.startswith("is_positive")]
        assert [outcome.verdict for outcome in asked] == [Verdict.FAIL] * 2, wrong.text()


NEAR = Tolerance(atol=1e-12, reason="rounding")


def double(x):
    return 2 * x


def up_to_zero(n):
    return np.arange(n, -1, -1)


def word(x):
    return "large"


def missing(x):
    return x * np.nan


def turned(x):
    return x + 1j


@pytest.mark.parametrize(
    ("function", "shape", "up_to", "reason"),
    [
        (double, (), "order", r"is for a list, but the right solution returned shape \(\)"),
        (double, (2,), "span", r"is for a matrix, but the right solution returned shape \(2,\)"),
        (turned, (2, 2), "column signs", "is for real numbers"),
        (double, (2, 2), "column phases", "is for complex numbers"),
    ],
)
def test_what_a_value_leaves_open_must_fit_it(function, shape, up_to, reason):
    inputs = {"x": array_of(shape, between(0, 1))}
    question = values(solution(function), inputs, Value(NEAR, up_to=up_to), truth=lambda x: x)
    with pytest.raises(AuthorError, match=f"up_to='{up_to}' {reason}"):
        list(next(question.scenes()).question)


@pytest.mark.parametrize(
    ("function", "inputs", "truth", "reason"),
    [
        (
            up_to_zero,
            {"n": integer(3, 9)},
            lambda n: np.arange(n + 1)[::-1],
            (
                r"up_to_zero must return shape \(\d+,\); it returned shape \(\d+,\); shape and type must be"
                r" the same"
            ),
        ),
        (
            double,
            {"x": lambda rng: np.ones(rng.integers(1, 9))},
            lambda x: x + x,
            r"x is drawn with shape \(\d,\) for one input and \(\d,\)",
        ),
        (
            double,
            {"x": array_of(3, between(1, 2))},
            lambda x: x[:2],
            r"the truth does not answer as .* shape \(3,\); it returned shape \(2,\)",
        ),
        (
            double,
            {"x": lambda rng: 1j * rng.random()},
            lambda x: x + x,
            "x is drawn with dtype complex128; arguments are real numbers",
        ),
        (
            word,
            {"x": between(1, 2)},
            lambda x: "large",
            "word returned 'large'; it must return numbers, booleans, or arrays",
        ),
        (
            missing,
            {"x": between(1, 2)},
            lambda x: x,
            "missing returned nan; ask it for inputs where its answer is finite",
        ),
        (
            double,
            {"x": between(1, 2)},
            missing,
            "the truth does not answer as .*: double returned a value that is not finite",
        ),
    ],
)
def test_a_type_or_shape_that_cannot_be_asked_is_the_author_s_error(function, inputs, truth, reason):
    question = values(solution(function), inputs, truth=truth, agree=NEAR)
    with pytest.raises(AuthorError, match=rf"assignment.py line \d+: question : \w+: .*{reason}"):
        for scene in question.scenes():
            scene.truth(scene.inputs(np.random.default_rng(1)) if callable(scene.inputs) else scene.inputs)


def test_a_value_that_is_not_finite_fails_alone(toolbox, sandbox):
    source = question_of(toolbox, "normal_modes").source.replace("np.sqrt(w2)", "np.sqrt(w2) * np.nan")
    found = {o.id: o for o in grade(Submission(source), toolbox.assignment, sandbox, 1).report.outcomes()}
    assert {id: o.verdict for id, o in found.items()} == {
        id: Verdict.FAIL if "omega" in id else Verdict.PASS
        for id in ("2-omega", "2-X", "2-new-omega", "2-new-X")
    }
    assert "omega holds values that are not finite numbers" in found["2-omega"].line


def test_a_wrong_shape_of_an_expression_is_not_said_to_be_returned(toolbox, sandbox):
    source = question_of(toolbox, "Pendulum").source.replace("2 * pi", "np.ones(2) * pi")
    report = grade(Submission(source), toolbox.assignment, sandbox, 1).report
    sentence = "`Pendulum(l, g).period()` must be a number; it is an array of shape (2,)"
    assert all(sentence in outcome.line for outcome in report.outcomes()), report.text()
