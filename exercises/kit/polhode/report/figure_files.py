"""Figures and contact sheets as files, drawn the same way on the server and in a notebook."""

import io
import math
import traceback
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polhode.judging.author_errors import LIBRARIES, AuthorError, has_truth, located, with_truth
from polhode.judging.checks import Arrays
from polhode.judging.exercise import Figure

COLUMNS = 3
WIDE, NARROW = (7.0, 3.6), (4.0, 3.2)  # inches; a narrow figure is as high for each of its panels


def draw(
    figure: Figure, seen: list[Arrays], truth: list[Arrays], form: str = "png", *, narrow: bool = False
) -> bytes:
    """Return the figure as ``form`` ("png" or "svg"). ``seen`` and ``truth`` hold one mapping of arrays per
    scene. A ``narrow`` figure is for a phone: panels that stand side by side are stacked.
    """
    import matplotlib as mpl
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure as Canvas

    made = _stacking(Canvas) if narrow else Canvas
    canvas = made(figsize=NARROW if narrow else WIDE, dpi=130, layout="constrained")
    FigureCanvasAgg(canvas)
    with np.errstate(all="ignore"):  # values that overflow are not drawn
        try:
            figure.draw(canvas, seen, truth)
        except Exception as error:
            if has_truth(seen, truth) or not isinstance(error, ArithmeticError | ValueError):
                _draw_truth(figure, truth, seen)
            raise
    stream = io.BytesIO()
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "polhode"}):
        metadata = {"Title": figure.title, "Description": figure.alt} | (
            {"Date": None} if form == "svg" else {}
        )
        canvas.savefig(stream, format=form, metadata=metadata)
    return stream.getvalue()


def _stacking(canvas: type[Any]) -> type[Any]:
    """Return a class of matplotlib figures that stack the panels of one row."""

    class Stacking(canvas):  # type: ignore[misc]
        def subplots(self, nrows: int = 1, ncols: int = 1, **more: Any) -> Any:
            if nrows == 1 and ncols > 1:
                nrows, ncols = self._stacked(ncols), 1
            return super().subplots(nrows, ncols, **more)

        def add_subplot(self, *place: Any, **more: Any) -> Any:
            if len(place) == 1 and isinstance(place[0], int):
                place = tuple(int(digit) for digit in str(place[0]))
            if len(place) == len("123") and place[0] == 1 < place[1]:
                place = self._stacked(place[1]), 1, place[2]
            return super().add_subplot(*place, **more)

        def _stacked(self, panels: int) -> int:
            self.set_size_inches(NARROW[0], NARROW[1] * panels)
            return panels

    return Stacking


def _draw_truth(figure: Figure, truth: list[Arrays], seen: list[Arrays]) -> None:
    """Draw the exact arrays in place of those returned. Raises AuthorError if that fails too."""
    from matplotlib.figure import Figure as Canvas

    try:
        figure.draw(Canvas(), with_truth(seen, truth), truth)
    except Exception as error:
        frames = traceback.extract_tb(error.__traceback__)
        own = [frame for frame in frames[1:] if not LIBRARIES & set(Path(frame.filename).parts)]
        raise AuthorError(f"figure {figure.name}: {located(error, (own or frames)[-1])}") from error


def contact_sheet(frames: NDArray[np.uint8]) -> bytes:
    """Return RGB stills (n, h, w, 3) as one PNG: in reading order, with white gaps."""
    from PIL import Image

    count, high, wide, _ = frames.shape
    rows = math.ceil(count / COLUMNS)
    sheet = np.full((rows * (high + 4), COLUMNS * (wide + 4), 3), 255, np.uint8)
    for number, still in enumerate(frames):
        top, left = (number // COLUMNS) * (high + 4), (number % COLUMNS) * (wide + 4)
        sheet[top : top + high, left : left + wide] = still
    stream = io.BytesIO()
    Image.fromarray(sheet).save(
        stream, format="PNG", compress_level=3
    )  # half the time of the default 6, and 3 % more bytes
    return stream.getvalue()
