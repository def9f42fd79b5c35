"""The sample right_course_notebook.ipynb: the course's notebook 2.6 as a student hands it in, filled in from
header to footer.

Setup and solutions are our own spelling; names, signatures, numbers, labels and tolerances are the course's.
"""

import json
from collections.abc import Iterable

from exercises.authoring.assignments.catalogue import assignments

FILE = assignments()["rigid-body"].folder / "samples" / "right_course_notebook.ipynb"
LABELS = (
    "principal moments match the analytic box result",
    "rotational energy conserved (torque-free)",
    "|L| conserved (torque-free)",
    "ω stays on the energy ellipsoid (T constant)",
    "ω stays on the angular-momentum ellipsoid (|L| constant)",
    "free precession rate is (I₃−I₁)/I₁·ω₃",
    "ω₃ is constant for the symmetric top",
    "spin is stable about the extreme axes, unstable about the intermediate axis",
    "the integrated orientation stays a proper rotation (RᵀR=I)",
)


def code(*left_out: str) -> dict[str, str]:
    """Sources of the code cells by id, without those whose tag or id is among ``left_out``."""
    cells = [
        cell for cell in json.loads(FILE.read_text(encoding="utf-8"))["cells"] if cell["cell_type"] == "code"
    ]
    kept = [cell for cell in cells if not {cell["id"], *cell["metadata"].get("tags", [])} & set(left_out)]
    return {cell["id"]: "".join(cell["source"]) for cell in kept}


def as_ipynb(cells: Iterable[str]) -> bytes:
    """The cells as a notebook file."""
    made = [
        {"cell_type": "code", "metadata": {}, "outputs": [], "execution_count": None, "source": cell}
        for cell in cells
    ]
    return json.dumps({"nbformat": 4, "nbformat_minor": 4, "metadata": {}, "cells": made}).encode()


def as_percent(cells: Iterable[str]) -> bytes:
    """The cells as jupytext's py:percent file, where a line magic is a comment."""
    head = "# ---\n# jupyter:\n#   jupytext:\n#     formats: ipynb,py:percent\n# ---\n\n"
    return (
        head + "\n\n".join(f"# %%\n{cell.replace('%matplotlib', '# %matplotlib')}" for cell in cells) + "\n"
    ).encode()
