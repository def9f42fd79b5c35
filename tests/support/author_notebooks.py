"""Assignments with an author's notebook, written into a folder."""

import json
import re

ASSIGNMENT = """
from exercises.authoring import Notebook, absolute, between, relative

notebook = Notebook("fall.ipynb", title="Falling")


@notebook.exercise("1", "Speed")
def the_speed(ask):
    speed = ask.function("speed")
    speed.case("", t=between(0, 3), g=between(1, 20))
    speed.truth(lambda t, g: t * g, agree=relative(1e-13, because="rounding"))
    speed.mistake(change="g * t -> g / 7.25")


@notebook.exercise("2", "Height")
def the_height(ask):
    height = ask.function("height")
    height.case("", t=between(0, 3), g=between(1, 20), h=100.0)
    height.truth(lambda t, g, h: h - 0.5 * g * t * t, agree=absolute(1e-11, because="rounding"))
"""


def markdown(source, **fields):
    return {"cell_type": "markdown", "metadata": {}, "source": source, **fields}


def code(source, *tags, **fields):
    return {
        "cell_type": "code",
        "metadata": {"tags": list(tags)},
        "execution_count": 7,
        "outputs": [],
        "source": source,
        **fields,
    }


SPEED = code(
    'def speed(t, g):\n    """Return the speed in m/s after t seconds."""\n    # g t\n'
    "    return SIGN * g * t",
    "solution",
)
HEIGHT = code("def height(t, g, h):\n    return h - g * t**2 / 2\n\n\nprint(height(1.0, 9.81, 100.0))")
CELLS = [
    markdown("# Falling"),
    markdown("## Setup"),
    code("%matplotlib inline\nimport numpy as np"),
    code("SIGN = 1.0"),
    markdown("## Exercise 1 — Speed\nText."),
    SPEED,
    markdown("### Validation 1"),
    code("assert speed(1.0, 9.81) == 9.81"),
    markdown("## Exercise 2 — Height"),
    HEIGHT,
    markdown("## Summary"),
    code("print('done')"),
]


def write(folder, cells=CELLS, assignment=ASSIGNMENT):
    """Write an assignment and its author's notebook into the folder ``falling`` and return it."""
    folder = folder / "falling"
    folder.mkdir(parents=True)
    (folder / "assignment.py").write_text(assignment)
    notebook = {
        "nbformat": 4,
        "nbformat_minor": 4,
        "metadata": {"kernelspec": {"name": "mine"}, "answers": ["private"]},
        "cells": cells,
    }
    (folder / "fall.ipynb").write_text(json.dumps(notebook))
    return folder


def solved(title, setup, numbers, solutions, given=re.compile("")):
    """The text of a notebook with a heading for each exercise, and each solution in a tagged cell; those that
    match ``given`` are given cells.
    """
    headings = [markdown(f"## Exercise {number}: {title}") for number in numbers]
    cells = [markdown(f"# {title}"), markdown("## Setup"), code(setup.strip()), *headings]
    cells += [code(text.strip(), *() if given.fullmatch(text) else ("solution",)) for text in solutions]
    return json.dumps({"cells": cells, "metadata": {}, "nbformat": 4, "nbformat_minor": 4})


def declared(folder, assignment, *solutions, setup="import numpy as np"):
    """Write an assignment and its notebook.ipynb with these solutions into a new folder, and return it."""
    folder.mkdir(parents=True)
    (folder / "assignment.py").write_text(assignment)
    numbers = re.findall(r'@notebook\.exercise\("(\w+)"', assignment)
    (folder / "notebook.ipynb").write_text(solved(folder.name, setup, numbers, solutions))
    return folder
