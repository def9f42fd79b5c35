"""The assignment tests/assignments/toolbox: its right solutions, its mistakes, and its kit."""

import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np

from exercises.authoring import Notebook
from exercises.authoring.assignments.assignment import Assignment
from exercises.authoring.assignments.catalogue import find
from polhode.judging.verdict import Verdict
from polhode.kinds import question_checks
from tests.support.kit import environment, installed

FOLDER = Path(__file__).parents[1] / "assignments" / "toolbox"


class Toolbox(NamedTuple):
    """The declaration and the assignment made from it."""

    notebook: Notebook
    assignment: Assignment


def right(toolbox):
    """The right solutions without the animations, which take a second each and have their own tests."""
    return "\n\n".join(
        question.source for question in toolbox.notebook.questions() if question.kind != "animation"
    )


def mistaken(toolbox, function, number):
    question = question_of(toolbox, function)
    return question.mistakes[number].source(question.source)


CHECK = """
import json, sys
sys.path.insert(0, {kit!r})
import polhode
polhode.connect(assignment={slug!r})
{setup}
{source}
report = polhode.check(assignment={slug!r})
print(json.dumps([{of} for outcome in report.outcomes()]))
"""


def check_locally(slug, source, folder, of="outcome.line"):
    """What ``polhode.check`` of the kit as students install it prints, as JSON.

    ``of`` is an expression for each ``outcome`` of the ``report``.
    """
    kit = installed(folder, slug)
    code = CHECK.format(kit=str(kit), setup=find(slug).setup, source=source, slug=slug, of=of)
    command = [sys.executable, "-c", code]
    return subprocess.run(command, check=True, capture_output=True, text=True, env=environment(kit)).stdout


def judged(question, solution, seed=1):
    """The outcomes of a question by check id for a function that runs here, without a sandbox. ``solution``
    may be its source.
    """
    if isinstance(solution, str):
        names = {"np": np}
        exec(solution, names)
        solution = names[question.function]
    outcomes = {}
    for scene in question.scenes():
        inputs = scene.inputs(np.random.default_rng(seed)) if callable(scene.inputs) else dict(scene.inputs)
        asked = dict(scene.question)
        seen, truth = question.play(solution, inputs, asked.get("part")), scene.truth(inputs)
        known = {name: truth[name] for name in scene.known}
        checks = question_checks(asked, scene.name, callable(scene.inputs))
        outcomes |= {check.id: check.judge([{**seen, **known}], [truth]) for check in checks}
    return outcomes


def failed(outcomes):
    """The ids of the checks that failed; all others passed."""
    assert all(outcome.verdict is not Verdict.UNMEASURED for outcome in outcomes.values())
    return {id for id, outcome in outcomes.items() if outcome.verdict is Verdict.FAIL}


def question_of(toolbox, function):
    return next(question for question in toolbox.notebook.questions() if question.function == function)
