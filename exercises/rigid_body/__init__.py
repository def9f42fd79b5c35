"""Notebook 2.6, "Rigid-Body Rotation and the Spinning Top"."""

from pathlib import Path

from exercises.assignment import Assignment
from exercises.rigid_body.causes import CODES, diagnose_function, diagnose_scene
from exercises.rigid_body.hidden_checks import EXERCISES
from exercises.rigid_body.scenes import SCENES
from exercises.rigid_body.sweep import SWEEP

ASSIGNMENT = Assignment(
    slug="rigid-body",
    title="2.6 Rigid-Body Rotation and the Spinning Top",
    version="1",
    folder=Path(__file__).parent,
    scenes=SCENES,
    exercises=EXERCISES,
    diagnose=diagnose_scene,
    diagnose_function=diagnose_function,
    sweep=SWEEP,
    codes=CODES,
)
