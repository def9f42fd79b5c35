"""An assignment for tests: a play with two functions, a variable, a class, and data files."""

from pathlib import Path

import numpy as np

from exercises.assignment import ArraySpec, Assignment, Scene

from .public import EXERCISES

X = [0.0, 1.0, 2.0]
NUMBER = {"value": ArraySpec(())}


def _number(value):
    return lambda inputs: {"value": np.array(value)}


SCENES = (
    Scene("line", "values", "model", {"x": X}, {"y": ArraySpec((3,))}, lambda inputs: {"y": 2 * np.array(inputs["x"])}, 2.0),
    Scene("misfit", "misfit", "residual", {"x": X, "y": X}, NUMBER, _number(5.0), 2.0, needs=("model",)),
    Scene("sum", "total", "total", {}, NUMBER, _number(6.0), 2.0),
    Scene("slope", "variable", "slope", {}, NUMBER, _number(2.0), 2.0),
    Scene("settings", "entry", "settings", {"key": "g"}, NUMBER, _number(9.81), 2.0),
    Scene("steps", "steps", "Pendulum", {"n": 3}, NUMBER, _number(3.0), 2.0),
)
ASSIGNMENT = Assignment(
    slug="lab-course",
    title="A lab course",
    version="1",
    folder=Path(__file__).parent,
    scenes=SCENES,
    exercises=EXERCISES,
    data=("points.csv", "runs/first.csv"),
)
