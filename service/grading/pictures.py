"""Pictures of a graded submission: figures drawn from its arrays, and contact sheets of its animations."""

import io
import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from exercises.assignment import Assignment
from exercises.assignment import Figure as Declared
from exercises.checks import Arrays
from service.grading.grade import Graded, draw_inputs, truth

FORMATS = {"png": "image/png", "svg": "image/svg+xml"}
COLUMNS = 6


def pack(graded: Graded) -> dict[str, bytes]:
    """What to keep of a graded submission, by artefact name: its arrays, and a contact sheet for each animation."""
    sheets = {a.scene: a.name for e in graded.exercises for a in e.animations if a.scene in graded.arrays}
    kept = {
        f"{scene}/{name}": array for scene, arrays in graded.arrays.items() if scene not in sheets for name, array in arrays.items()
    }
    stream = io.BytesIO()
    np.savez(stream, **kept)  # type: ignore[arg-type]
    packed = {"arrays.npz": stream.getvalue()}
    for scene, name in sheets.items():
        packed[f"animations/{name}.png"] = contact_sheet(graded.arrays[scene]["frames"])
    return packed


def unpack(data: bytes) -> dict[str, dict[str, NDArray[np.float64]]]:
    """The arrays by scene and name, from what ``pack`` wrote."""
    scenes: dict[str, dict[str, NDArray[np.float64]]] = {}
    with np.load(io.BytesIO(data), allow_pickle=False) as archive:
        for key in archive.files:
            scene, name = key.split("/")
            scenes.setdefault(scene, {})[name] = archive[key]
    return scenes


def find(assignment: Assignment, name: str) -> Declared | None:
    """The figure of that name, or None."""
    return next((f for e in assignment.exercises for f in e.figures if f.name == name), None)


def draw(assignment: Assignment, figure: Declared, arrays: Mapping[str, Arrays], seed: int, form: str) -> bytes:
    """The figure as ``form`` ("png" or "svg") from the arrays a submission brought back and the exact motion beside them."""
    import matplotlib as mpl
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    scenes = [assignment.scene(name) for name in figure.scenes]
    exact = [truth(s, draw_inputs(s, seed)) for s in scenes]
    canvas = Figure(figsize=(9, 4.5), dpi=100)
    FigureCanvasAgg(canvas)
    figure.draw(canvas, [arrays[s.name] for s in scenes], exact)
    stream = io.BytesIO()
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "polhode"}):
        metadata = {"Title": figure.title, "Description": figure.alt} | ({"Date": None} if form == "svg" else {})
        canvas.savefig(stream, format=form, metadata=metadata)
    return stream.getvalue()


def contact_sheet(frames: NDArray[np.uint8]) -> bytes:
    """RGB stills (n, h, w, 3) as one PNG, in reading order, half size, white between them."""
    from PIL import Image

    small = frames[:, ::2, ::2]
    count, high, wide, _ = small.shape
    rows = math.ceil(count / COLUMNS)
    sheet = np.full((rows * (high + 4), COLUMNS * (wide + 4), 3), 255, np.uint8)
    for number, still in enumerate(small):
        top, left = (number // COLUMNS) * (high + 4), (number % COLUMNS) * (wide + 4)
        sheet[top : top + high, left : left + wide] = still
    stream = io.BytesIO()
    Image.fromarray(sheet).save(stream, format="PNG")
    return stream.getvalue()
