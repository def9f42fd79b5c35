"""Every argument of every kind: a value of a wrong type is an error with its line, and any other can be
asked.
"""

import inspect
import json
import math
import re
import traceback

import numpy as np
import pytest

from exercises.authoring.draws import array_of, between
from exercises.authoring.draws import expression as function_argument
from exercises.authoring.kinds.animation import animation
from exercises.authoring.kinds.expression import expression, symbol
from exercises.authoring.kinds.fit import fit
from exercises.authoring.kinds.ode import ode
from exercises.authoring.kinds.random import estimate, generator, samples
from exercises.authoring.kinds.stepper import euler, stepper
from exercises.authoring.kinds.values import values
from exercises.authoring.kinds.variables import Claim, variables
from exercises.authoring.questions.author_arguments import Value
from exercises.authoring.questions.question_errors import question_errors
from polhode.judging.author_errors import AuthorError
from polhode.judging.outcome import Tolerance
from polhode.kinds import question_checks
from tests.support.solutions import cell, solution

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
        "solution": solution(double),
        "inputs": {"x": between(0, 1)},
        "truth": lambda x: x + x,
        "agree": NEAR,
    },
    ode: {
        "solution": solution(decay),
        "inputs": {"t": 0.0, "y": between(1, 2), "k": between(0.1, 1)},
        "agree": NEAR,
        "until": 0.5,
        "follow": LIMIT,
        "motion": lambda t, y, k: y * np.exp(-k * t),
        "conserved": {"c": ("y * exp(k * t)", LIMIT)},
    },
    stepper: {
        "solution": solution(step),
        "inputs": {
            "f": function_argument("-y", of="t y"),
            "t": 0.0,
            "y": array_of(2, between(1, 2)),
            "h": 0.1,
        },
        "agree": NEAR,
        "truth": euler,
        "order": (1, ATOL),
        "stable_to": (2, NEAR),
    },
    samples: {
        "solution": solution(noise),
        "inputs": {"n": 30, "rng": generator()},
        "distribution": "norm",
        "repetitions": 2,
        "scale": 1,
    },
    estimate: {
        "solution": solution(mean),
        "inputs": {"n": 30, "rng": generator()},
        "truth": 0.0,
        "sd": lambda n: n ** (-0.5),
        "repetitions": 2,
    },
    variables: {
        "solution": cell("g = 9.81", "g"),
        "truth": {"g": 9.81},
        "agree": {"g": NEAR},
        "claims": [Claim("g > 9", "g is large", "g is")],
    },
    expression: {
        "solution": solution(square),
        "inputs": {"z": symbol(1, 2)},
        "truth": lambda z: z * z,
        "agree": NEAR,
    },
    fit: {
        "solution": solution(line),
        "model": lambda x, a, b: a + b * x,
        "x": TIMES,
        "sigma": 0.3,
        "drawn": {"a": between(-3, 3), "b": between(-1, 1)},
        "parameters": LIMIT,
        "covariance": LIMIT,
    },
    animation: {
        "solution": solution(draw),
        "inputs": {"t": TIMES, "x": np.stack([TIMES, TIMES], axis=1)},
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
    Value(3),
    Value(NEAR, label=3),
    Value(NEAR, up_to=[]),
    Value(NEAR, statistic=1),
    {"a": Value(NEAR), "b": 3},
    {"a": ("y *", LIMIT)},
    {"a": ("y", NEAR)},
    {"a": "y"},
    lambda *a: 0,
    lambda q: 0,
    function_argument(3, of="x"),
    {"x": function_argument("x", of="x", x=object())},
    [Claim(1, 2, 3)],
    Claim("x", "l", "r"),
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


NOT_THE_AUTHORS = ("solution", "uses")  # found in the notebook
CASES = [
    (kind, name)
    for kind in RIGHT
    for name, parameter in inspect.signature(kind).parameters.items()
    if name not in NOT_THE_AUTHORS and parameter.kind is not parameter.VAR_KEYWORD
]


@pytest.mark.parametrize(
    "asked", [False, pytest.param(True, marks=pytest.mark.slow)], ids=["declared", "asked"]
)
@pytest.mark.parametrize(("kind", "name"), CASES, ids=[f"{kind.__name__}-{name}" for kind, name in CASES])
@pytest.mark.filterwarnings("ignore")
def test_an_argument_is_refused_with_its_line_or_can_be_asked(kind, name, asked):
    refused = 0
    for other in OTHERS:
        question = kind(**RIGHT[kind] | {name: other})
        errors = list(question_errors(question))
        assert all(error.startswith("line 0: ") for error in errors), errors
        assert not any(
            error.split(": ")[2:3] in (["TypeError"], ["KeyError"], ["AttributeError"]) for error in errors
        ), errors
        refused += bool(errors)
        if asked and not errors:
            try:
                use(question)
            except AuthorError as error:
                assert re.match(r"assignment.py line \d+: ", str(error)), f"{name}={other!r}"
            except Exception as error:  # an exception of the author's code has its line
                frames = [frame.name for frame in traceback.extract_tb(error.__traceback__)]
                if question.function not in frames:
                    raise AssertionError(f"{name}={other!r} is accepted, but cannot be asked") from error
    assert refused > len(OTHERS) / 2
