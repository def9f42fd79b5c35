"""Every argument of every kind: a value of a wrong type is an error with its line, and any other can be
asked.
"""

import inspect
import json
import math
import re
import sys
import traceback

import numpy as np
import pytest

from exercises.authoring.kinds.animation import animation
from exercises.authoring.kinds.expression import expression, symbol
from exercises.authoring.kinds.fit import fit
from exercises.authoring.kinds.ode import ode
from exercises.authoring.kinds.random import estimate, generator, samples
from exercises.authoring.kinds.stepper import euler, stepper
from exercises.authoring.kinds.values import values
from exercises.authoring.kinds.variables import claim, variables
from exercises.authoring.questions.author import Tolerance, Value, family, mistake, uniform
from exercises.authoring.questions.question_errors import question_errors, uses_errors
from polhode.judging.author_errors import AuthorError
from polhode.kinds import question_checks

NEAR, LIMIT, ATOL = (
    Tolerance(**number, reason="of a test") for number in ({"rtol": 1e-9}, {"limit": 1e-9}, {"atol": 0.2})
)


def double(x):
    return 2 * x


def decay(t, y, k):
    return -k * y


def step(f, t, y, h):
    return y + h * f(t, y)


def noise(n, rng):
    return rng.normal(size=n)


def mean(n, rng):
    return rng.normal(size=n).mean()


def cell():
    g = 9.81
    return g


def square(z):
    return z**2


def line(x, y, sigma):
    A = np.stack([np.ones_like(x), x], axis=1) / sigma[:, None]
    C = np.linalg.inv(A.T @ A)
    return C @ A.T @ (y / sigma), C


def draw(t, x):
    raise NotImplementedError


TIMES = np.linspace(0, 1, 9)
RIGHT = {
    values: {
        "solution": double,
        "ask": {"x": uniform(0, 1)},
        "truth": lambda x: x + x,
        "agree": NEAR,
        "mistakes": [mistake("2 *", "3 *")],
    },
    ode: {
        "solution": decay,
        "ask": {"t": 0.0, "y": uniform(1, 2), "k": uniform(0.1, 1)},
        "agree": NEAR,
        "t_end": 0.5,
        "follow": LIMIT,
        "motion": lambda t, y, k: y * np.exp(-k * t),
        "conserved": {"c": ("y * exp(k * t)", LIMIT)},
    },
    stepper: {
        "solution": step,
        "ask": {"f": family("-y", "t", "y"), "t": 0.0, "y": uniform(1, 2, 2), "h": 0.1},
        "agree": NEAR,
        "truth": euler,
        "order": (1, ATOL),
        "stability": (2, NEAR),
    },
    samples: {
        "solution": noise,
        "ask": {"n": 30, "rng": generator()},
        "distribution": "norm",
        "repetitions": 2,
        "scale": 1,
    },
    estimate: {
        "solution": mean,
        "ask": {"n": 30, "rng": generator()},
        "truth": 0.0,
        "sd": lambda n: n ** (-0.5),
        "repetitions": 2,
    },
    variables: {
        "solution": cell,
        "truth": {"g": 9.81},
        "agree": {"g": NEAR},
        "claims": [claim("g > 9", "g is large", reason="g is")],
    },
    expression: {"solution": square, "ask": {"z": symbol(1, 2)}, "truth": lambda z: z * z, "agree": NEAR},
    fit: {
        "solution": line,
        "model": lambda x, a, b: a + b * x,
        "x": TIMES,
        "sigma": 0.3,
        "drawn": {"a": uniform(-3, 3), "b": uniform(-1, 1)},
        "agree": (LIMIT, LIMIT),
    },
    animation: {
        "solution": draw,
        "ask": {"t": TIMES, "x": np.stack([TIMES, TIMES], axis=1)},
        "follow": ("x",),
        "agree": LIMIT,
    },
}
OTHERS = [
    None,
    True,
    0,
    -3,
    2.5,
    math.nan,
    1j,
    1001,
    "",
    "a b",
    "y",
    b"y",
    object(),
    type,
    len,
    np.sin,
    np.zeros(0),
    np.array([1j]),
    (),
    [],
    [1],
    (2, 3),
    (1, NEAR),
    (1, "a"),
    (NEAR, NEAR),
    [None],
    {},
    {1: 2},
    {"x": object()},
    {"y": [[1], [1, 2]]},
    {"g": None},
    {"g": NEAR},
    NEAR,
    LIMIT,
    ATOL,
    Tolerance(reason="of a test"),
    Tolerance(limit=1.0, reason=3),
    Tolerance(limit="1", reason="of a test"),
    Tolerance(limit=1.0, atol=1.0, reason="both"),
    Value(3),
    Value(NEAR, label=3),
    Value(NEAR, up_to=[]),
    Value(NEAR, points="2"),
    Value(NEAR, partial=1),
    {"a": Value(NEAR), "b": 3},
    {"a": ("y *", LIMIT)},
    {"a": ("y", NEAR)},
    {"a": "y"},
    lambda *a: 0,
    lambda q: 0,
    family(3, "x"),
    family("x", 3),
    {"x": family("x", "x", x=object())},
    [mistake(1, 2)],
    [mistake("2", "3", 4, 5)],
    [claim(1, 2, reason=3)],
    claim("x", "l", reason="r"),
    (-1, 4),
    (3, -1),
    (3, 2.0),
    (0, 0),
    ("t", 1),
    {"x": 1j},
    {"x": np.array(["a"])},
    {"a": lambda rng: "b"},
]


def use(question):
    """Ask the question as the server would, except for an animation."""
    json.dumps(question.document)
    for scene in question.scenes() if question.kind != "animation" else ():
        inputs = scene.inputs(np.random.default_rng(1)) if callable(scene.inputs) else dict(scene.inputs)
        asked, _ = dict(scene.question), dict(scene.returns)
        truth = scene.truth(inputs)
        seen = question.play(question.student, inputs, asked.get("part")) | {
            name: truth[name] for name in scene.known
        }
        for check in question_checks(asked, scene.name, callable(scene.inputs)):
            assert not check.errors() and check.judge([seen], [truth]).line


CASES = [
    (kind, name) for kind in RIGHT for name in inspect.signature(kind).parameters if name != "parameters"
]


@pytest.mark.parametrize(
    "asked", [False, pytest.param(True, marks=pytest.mark.slow)], ids=["declared", "asked"]
)
@pytest.mark.parametrize(("kind", "name"), CASES, ids=[f"{kind.__name__}-{name}" for kind, name in CASES])
@pytest.mark.filterwarnings("ignore")
def test_an_argument_is_refused_with_its_line_or_can_be_asked(kind, name, asked):
    refused = 0
    for other in OTHERS:
        question, at = kind(**RIGHT[kind] | {name: other}), sys._getframe().f_lineno
        errors = [*question_errors(question), *uses_errors(question, [])]
        assert all(re.match(rf"line ({at}|\d+): ", error) for error in errors), errors
        assert not any(
            error.split(": ")[2:3] in (["TypeError"], ["KeyError"], ["AttributeError"]) for error in errors
        ), errors
        refused += bool(errors)
        if asked and not errors:
            try:
                use(question)
            except AuthorError as error:
                assert re.match(r"test_kinds.py line \d+: ", str(error)), f"{name}={other!r}"
            except Exception as error:  # an exception of the author's code has its line
                frames = [frame.name for frame in traceback.extract_tb(error.__traceback__)]
                if question.function not in frames:
                    raise AssertionError(f"{name}={other!r} is accepted, but cannot be asked") from error
    assert refused > len(OTHERS) / 2
