"""The assignment tests/assignments/toolbox: its right solutions, its mistakes, and its kit."""

import io
import os
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import NamedTuple

from exercises import wheel
from exercises.assignment import Assignment
from exercises.author import Notebook
from exercises.catalogue import find

FOLDER = Path(__file__).parents[1] / "assignments" / "toolbox"


class Toolbox(NamedTuple):
    """The declaration and the assignment made from it."""

    notebook: Notebook
    assignment: Assignment


def right(toolbox):
    """The right solutions without the animations, which take a second each and have their own tests."""
    return "\n\n".join(question.source for question in toolbox.notebook.questions() if question.kind != "animation")


def mistaken(toolbox, function, number):
    question = next(question for question in toolbox.notebook.questions() if question.function == function)
    return question.mistakes[number].source(question.source)


CHECK = """
import json, sys
sys.path.insert(0, {kit!r})
{setup}
{source}
import ecp
print(json.dumps([outcome.line for outcome in ecp.check(assignment={slug!r}).outcomes()]))
"""


def check_locally(slug, source, folder):
    """What ``ecp.check`` of the kit as students install it prints, as JSON."""
    kit = folder / "kit"
    zipfile.ZipFile(io.BytesIO(wheel.wheel())).extractall(kit)
    setup = find(slug).setup
    code = CHECK.format(kit=str(kit), setup=setup, source=source, slug=slug)
    clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    return subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True, env=clean).stdout
