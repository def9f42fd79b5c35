"""An assignment for tests: a play with two functions, a variable, a class, and data files."""

import numpy as np

from exercises.authoring.assignments.assignment import ArraySpec, Scene
from exercises.authoring.questions.author import Notebook

from .public import EXERCISES

X = [0.0, 1.0, 2.0]
NUMBER = {"value": ArraySpec(())}


def _number(value):
    return lambda inputs: {"value": np.array(value)}


SCENES = (
    Scene(
        "line",
        "values",
        "model",
        {"x": X},
        {"y": ArraySpec((3,))},
        lambda inputs: {"y": 2 * np.array(inputs["x"])},
        2.0,
    ),
    Scene("misfit", "misfit", "residual", {"x": X, "y": X}, NUMBER, _number(5.0), 2.0, needs=("model",)),
    Scene("sum", "total", "total", {}, NUMBER, _number(6.0), 2.0),
    Scene("slope", "variable", "slope", {}, NUMBER, _number(2.0), 2.0),
    Scene("settings", "entry", "settings", {"key": "g"}, NUMBER, _number(9.81), 2.0),
    Scene("steps", "steps", "Pendulum", {"n": 3}, NUMBER, _number(3.0), 2.0),
)
notebook = Notebook(
    "A lab course",
    setup='import numpy as np\n\nPOINTS = np.loadtxt("points.csv")\n',
    data=("points.csv", "runs/first.csv"),
    scenes=SCENES,
)
for exercise in EXERCISES:
    notebook.own_exercise(exercise)
