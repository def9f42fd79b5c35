"""Images of a graded submission: figures drawn from its arrays, and contact sheets of its animations."""

import io
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ecp import drawing
from ecp.checks import Arrays
from ecp.exercise import Figure
from exercises.assignment import Assignment
from service.grading.author_errors import author_errors
from service.grading.grade import Graded, draw_inputs, truth

FORMATS = {"png": "image/png", "svg": "image/svg+xml"}


def pack(graded: Graded) -> dict[str, bytes]:
    """Return the artefacts to store, by name: the arrays, and a contact sheet for each animation."""
    sheets = {a.scene: a.name for e in graded.exercises for a in e.animations if a.scene in graded.arrays}
    arrays_by_key = {
        f"{scene}/{name}": array for scene, arrays in graded.arrays.items() if scene not in sheets for name, array in arrays.items()
    }
    stream = io.BytesIO()
    np.savez(stream, **arrays_by_key)  # type: ignore[arg-type]
    packed = {"arrays.npz": stream.getvalue()}
    for scene, name in sheets.items():
        packed[f"animations/{name}.png"] = drawing.contact_sheet(graded.arrays[scene]["frames"])
    return packed


def unpack(data: bytes) -> dict[str, dict[str, NDArray[np.float64]]]:
    """Return the arrays that ``pack`` wrote, by scene and name."""
    scenes: dict[str, dict[str, NDArray[np.float64]]] = {}
    with np.load(io.BytesIO(data), allow_pickle=False) as archive:
        for key in archive.files:
            scene, name = key.split("/")
            scenes.setdefault(scene, {})[name] = archive[key]
    return scenes


def find(assignment: Assignment, name: str) -> Figure | None:
    """Return the figure of that name, or None."""
    return next((f for e in assignment.exercises for f in e.figures if f.name == name), None)


def draw(assignment: Assignment, figure: Figure, arrays: Mapping[str, Arrays], seed: int, form: str) -> bytes:
    """Draw a figure from a submission's arrays and the exact motion, as ``form`` ("png" or "svg")."""
    scenes = [assignment.scene(name) for name in figure.scenes]
    with author_errors(assignment):
        exact = [truth(s, draw_inputs(s, seed)) for s in scenes]
    with author_errors(assignment, numbers=True):
        return drawing.draw(figure, [arrays[s.name] for s in scenes], exact, form)
