"""Images: figures and contact sheets of a graded submission, and sweeps of one or of a class."""

import io
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exercises.authoring.assignments.assignment import Assignment
from polhode.judging.checks import Arrays
from polhode.judging.exercise import Figure
from polhode.judging.outcome import SweepResult
from polhode.report import figure_files
from polhode.report.dataclass_json import read
from service.grading.author_errors import author_errors, find_assignment
from service.grading.figures import speed_vs_accuracy
from service.grading.figures.chart_drawing import draw as draw_chart
from service.grading.grade import Graded
from service.grading.graded_file import ARRAYS
from service.grading.sandbox_job import draw_inputs, truth

FORMATS = {"png": "image/png", "svg": "image/svg+xml"}
MOST_CALLS, MOST_SECONDS = 10**9, 1e6  # of one solver in a sweep; assignments allow less


def pack(graded: Graded) -> dict[str, bytes]:
    """Return the artefacts to store, by name: the arrays, and a contact sheet for each animation."""
    sheets = {a.scene: a.name for e in graded.exercises for a in e.animations if a.scene in graded.arrays}
    own = {
        f"{scene}/{name}": array
        for scene, arrays in graded.arrays.items()
        for name, array in arrays.items()
        if scene not in sheets
    }
    packed = {ARRAYS: _archive(own)}
    for scene, name in sheets.items():
        packed[f"animations/{name}.png"] = figure_files.contact_sheet(graded.arrays[scene]["frames"])
    return packed


def _archive(arrays: Arrays) -> bytes:
    stream = io.BytesIO()
    np.savez(stream, **arrays)  # type: ignore[arg-type]
    return stream.getvalue()


def unpack(packed: bytes) -> dict[str, dict[str, NDArray[np.float64]]]:
    """Return the arrays that ``pack`` wrote, by scene and name."""
    scenes: dict[str, dict[str, NDArray[np.float64]]] = {}
    with np.load(io.BytesIO(packed), allow_pickle=False) as archive:
        for key in archive.files:
            scene, name = key.split("/")
            scenes.setdefault(scene, {})[name] = archive[key]
    return scenes


def find(assignment: Assignment, name: str) -> Figure | None:
    """Return the figure of that name, or None."""
    return next((f for e in assignment.exercises for f in e.figures if f.name == name), None)


def draw(
    assignment: Assignment,
    figure: Figure,
    arrays: Mapping[str, Arrays],
    seed: int,
    form: str,
    *,
    narrow: bool = False,
) -> bytes:
    """Draw a figure from a submission's arrays and the exact motion, as ``form`` ("png" or "svg")."""
    scenes = [assignment.scene(name) for name in figure.scenes]
    with author_errors(assignment):
        exact = [truth(s, draw_inputs(s, seed)) for s in scenes]
    with author_errors(assignment, numbers=True):
        return figure_files.draw(figure, [arrays[s.name] for s in scenes], exact, form, narrow=narrow)


def prepare(slug: str) -> None:
    """Load an assignment and matplotlib, so that its first figure takes as long as any other. Raises
    SystemFault.
    """
    import matplotlib.backends.backend_agg  # noqa: F401

    find_assignment(slug)


def draw_stored(
    slug: str, figure: str, packed: bytes, seed: int, form: str, *, narrow: bool = False
) -> bytes:
    """Draw a figure of a graded submission from its ``packed`` arrays. Raises KeyError if there is no such
    figure, SystemFault.
    """
    assignment = find_assignment(slug)
    declared = find(assignment, figure)
    if declared is None:
        raise KeyError(figure)
    return draw(assignment, declared, unpack(packed), seed, form, narrow=narrow)


def draw_sweep(swept: SweepResult) -> bytes:
    """Draw speed against accuracy of a submission, as SVG."""
    return draw_chart(speed_vs_accuracy.card(swept))


def draw_class(documents: Sequence[dict[str, Any]]) -> bytes:
    """Draw the sweeps of a class, as JSON. Uses the most frequent scene only."""
    found = [swept for swept in (read(SweepResult, one) for one in documents) if plausible(swept)]
    scene = Counter([swept.scene for swept in found] or [""]).most_common(1)[0][0]
    return draw_chart(speed_vs_accuracy.of_class(scene, [s.points for s in found if s.scene == scene]))


def plausible(swept: SweepResult) -> bool:
    """Return whether every number of a sweep is finite and in its range, so that it can be drawn."""
    return all(
        1 <= p.calls <= MOST_CALLS
        and 0 <= p.seconds <= MOST_SECONDS
        and (p.error is None or 0 <= p.error < math.inf)
        for p in swept.points
    )
