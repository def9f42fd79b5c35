"""One exercise of the author's own: the equation of motion of a damped oscillator, checked against its
closed-form solution.
"""

from exercises.authoring.questions.author import Notebook

from .causes import CODES, diagnose
from .hidden_checks import RATES
from .public import OSCILLATOR
from .scenes import SCENES

notebook = Notebook(
    "The damped oscillator",
    notebook="notebook.ipynb",
    version="1",  # change it with every change of a check, scene or tolerance; reports contain it
    scenes=SCENES,
    diagnose=diagnose,
    codes=CODES,
)
notebook.own_exercise(OSCILLATOR, RATES)
