"""The declaration of notebook 2.6: six exercises of its own."""

from dataclasses import replace

from exercises.authoring.questions.author import Notebook
from exercises.rigid_body.bounds import with_bound
from exercises.rigid_body.causes import CODES, diagnose_function, diagnose_scene
from exercises.rigid_body.hidden_checks import FOLLOWING, HIDDEN
from exercises.rigid_body.public import EXERCISES
from exercises.rigid_body.scenes import SCENES
from exercises.rigid_body.sweep import SWEEP

notebook = Notebook(
    "2.6 Rigid-Body Rotation and the Spinning Top",
    notebook="notebook.ipynb",
    scenes=SCENES,
    diagnose=diagnose_scene,
    diagnose_function=diagnose_function,
    sweep=SWEEP,
    codes=CODES,
)
for exercise in EXERCISES:
    checks = [with_bound(check) if check.id in FOLLOWING else check for check in exercise.checks]
    notebook.own_exercise(replace(exercise, checks=checks), *HIDDEN[exercise.number])
