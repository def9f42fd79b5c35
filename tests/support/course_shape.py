"""Notebooks of our own in the shape in which the course publishes its notebooks, and as students hand them
in.
"""

import json
from pathlib import Path

from tests.support.course_notebook import FILE

HIDDEN = "# (solution hidden on the public site)\n"
SETUP = "import numpy as np\n\nfrom ecp import validate\n\n\ndef double(x):\n    return 2 * x\n"
SOLUTIONS = (
    "total = sum(range(5))\n",
    "powers = [2**n for n in range(4)]\n",
    "area = 4 * sum(1 / (2 * k + 1) * (-1) ** k for k in range(9999))\n",
)
CHECKS = (
    (
        'validate.close(double(total), 20, "twice the sum is 20")\n'
        'validate.check(total > 0, "the sum is positive", f"sum {total}")\n'
    ),
    (
        "for n, power in enumerate(powers):\n"
        '    validate.close(power, 2**n, f"2 to the power {n}", rtol=1e-12)\n'
    ),
    (
        'validate.close(area, np.pi, "the series is near π", rtol=1e-3)\n'
        'validate.positive(area, label="the area is positive")\n'
    ),
)


def notebook(*cells):
    """A notebook of (type, id, tags, source)."""
    made = []
    for kind, id, tags, source in cells:
        cell = {"cell_type": kind, "id": id, "metadata": {"tags": tags} if tags else {}, "source": source}
        made.append(cell | ({"outputs": [], "execution_count": None} if kind == "code" else {}))
    return json.dumps({"cells": made, "metadata": {}, "nbformat": 4, "nbformat_minor": 5})


def published(solutions=(HIDDEN,) * 3, setup=SETUP, checks=CHECKS):
    """Three exercises. ``solutions``, ``setup`` and ``checks`` are the sources of the cells; None leaves a
    cell out.
    """
    cells = [
        ("markdown", "title", [], "# 9.9 Small sums"),
        ("markdown", "setup-text", [], "## Setup"),
        ("code", "setup", [], setup),
    ]
    for k, (solution, check) in enumerate(zip(solutions, checks, strict=True), 1):
        cells += [
            ("markdown", f"exercise-{k}", [], f"## Exercise {k} — Task {k}"),
            ("code", f"solution-{k}", ["solution"], solution),
            ("markdown", f"validation-text-{k}", [], f"### Validation {k} — lines"),
            ("code", f"validation-{k}", ["validation"], check),
        ]
    return notebook(*[cell for cell in cells if cell[3] is not None])


def bare(*sources):
    """A notebook of code cells without ids, as `polhode.submit` sends it."""
    cells = [
        {"cell_type": "code", "metadata": {}, "source": s, "outputs": [], "execution_count": None}
        for s in sources
    ]
    return json.dumps({"cells": cells, "metadata": {}, "nbformat": 4, "nbformat_minor": 4})


def course_notebook():
    """Notebook 2.6 as the course publishes it: with emptied solution cells."""
    cells = json.loads(FILE.read_text(encoding="utf-8"))
    for cell in cells["cells"]:
        if "solution" in cell["metadata"].get("tags", []):
            cell["source"] = HIDDEN
    return json.dumps(cells)


def written(folder: Path, name: str, text: str) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name
