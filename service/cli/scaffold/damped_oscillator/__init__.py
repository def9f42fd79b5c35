"""One exercise: the equation of a damped oscillator, judged by its closed form."""

from pathlib import Path

from exercises.assignment import Assignment

from .causes import CODES, diagnose
from .hidden_checks import EXERCISES
from .scenes import SCENES

ASSIGNMENT = Assignment(
    slug="damped-oscillator",  # as the folder is called
    title="The damped oscillator",
    version="1",  # another one when a check, a scene or a tolerance changes: reports name it
    folder=Path(__file__).parent,
    scenes=SCENES,
    exercises=EXERCISES,
    diagnose=diagnose,
    codes=CODES,
)
