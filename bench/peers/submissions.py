"""The graded submissions: the notebook's Setup cell and an ``euler_eqs`` of the samples, as a script and as a
notebook.
"""

import ast
import json
from dataclasses import dataclass
from itertools import cycle
from pathlib import Path

from bench.forms import FORMS
from exercises.authoring.assignments.catalogue import find

FOLDER = find("rigid-body").folder
SAMPLES = {
    "right": "right_terms.py",
    "sign slip": "wrong_sign_flipped.py",
    "zeros": "wrong_zeros.py",
    "reversed in time": "wrong_time_reversed.py",
    "np.max patched": "hostile_patched_max.py",
}
FUTURE = "from __future__ import annotations\n"
COURSE = """import matplotlib.pyplot as plt
from matplotlib.animation import FuncAnimation
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
import numpy as np
from scipy.integrate import solve_ivp
"""


@dataclass(frozen=True)
class Submission:
    """What one student sends; ``name`` names files and folders."""

    name: str
    setup: str
    answer: str

    @property
    def script(self) -> str:
        """Return a .py file."""
        return f"{self.setup}\n\n{self.answer}"

    @property
    def notebook(self) -> str:
        """Return a .ipynb file with two cells."""
        return notebook([code_cell("setup", self.setup), code_cell("euler", self.answer)])


def submissions(batch: int) -> dict[str, Submission]:
    """Return the submissions by name: one of each kind, the correct FORMS, and ``batch`` copies of these."""
    setup = COURSE + "\n\n" + _setup_functions()
    files = {file_name(kind): file for kind, file in SAMPLES.items()}
    files |= {form: f"right_{form}.py" for form in FORMS}
    files |= {name: f"right_{form}.py" for name, form in zip(copies(batch), cycle(FORMS), strict=False)}
    found = []
    for name, file in files.items():
        answer = (FOLDER / "samples" / file).read_text()
        first = FUTURE if FUTURE in answer else ""  # nothing may precede it
        found.append(Submission(name, first + setup, f"{answer.replace(FUTURE, '')}\n# {name}\n"))
    return {s.name: s for s in found}


def copies(batch: int) -> list[str]:
    """Return the names of the copies."""
    return [f"copy-{k}" for k in range(batch)]


def file_name(kind: str) -> str:
    """Return the file name of a kind of submission."""
    return kind.replace(" ", "-").replace(".", "-")


def notebook(cells: list[dict]) -> str:
    """Return a Python notebook (nbformat 4.5)."""
    kernel = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    return json.dumps({"nbformat": 4, "nbformat_minor": 5, "metadata": kernel, "cells": cells}, indent=1)


def code_cell(id: str, source: str, **metadata: object) -> dict:
    """Return a code cell without output."""
    return {
        "cell_type": "code",
        "id": id,
        "metadata": metadata,
        "source": source,
        "execution_count": None,
        "outputs": [],
    }


def write(path: Path, text: str) -> None:
    """Write a file, creating its folder."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def _setup_functions() -> str:
    """Return T_rot, L_body and integrate_body verbatim from the course's Setup cell."""
    text, names = find("rigid-body").setup, ("T_rot", "L_body", "integrate_body")
    functions = [
        node for node in ast.parse(text).body if isinstance(node, ast.FunctionDef) and node.name in names
    ]
    found = [ast.get_source_segment(text, node) for node in functions]
    return "\n\n\n".join(f for f in found if f) + "\n"
