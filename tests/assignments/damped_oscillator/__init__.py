"""One exercise: the equation of motion of a damped oscillator, checked against its closed-form solution."""

from pathlib import Path

from exercises.assignment import Assignment

from .causes import CODES, diagnose
from .hidden_checks import EXERCISES
from .scenes import SCENES

ASSIGNMENT = Assignment(
    slug="damped-oscillator",  # the folder name, with - for _
    title="The damped oscillator",
    version="1",  # change it with every change of a check, scene or tolerance; reports contain it
    folder=Path(__file__).parent,
    scenes=SCENES,
    exercises=EXERCISES,
    diagnose=diagnose,
    codes=CODES,
)
