"""Panes, grid lines and ticks of 3-D axes: most of the time of a drawing,
and the same from frame to frame.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np

PARTS = ("draw_pane", "draw_grid", "draw")


@contextmanager
def decorated_once() -> Iterator[None]:
    """Inside the ``with`` block, copy the decoration of 3-D axes from their last drawing if it would be the
    same.

    It is the same if the pixels behind it, camera, limits and size are, and nothing was set in an axis since.
    matplotlib draws it before everything else in the axes.
    """
    from mpl_toolkits.mplot3d.axis3d import Axis

    own: dict[str, Any] = {name: getattr(Axis, name, None) for name in PARTS}
    begun: dict[Any, Any] = {}  # by axes and whether without text: what the decoration depends on
    last: dict[Any, Any] = {}  # the same, and the pixels with it
    copied: set[Any] = set()  # the axes whose present drawing has a copy

    def begin(axes: Any, renderer: Any) -> None:
        if any(part.stale for axis in axes._axis_map.values() for part in (axis, axis.pane)):
            last.clear()
        pixels, key = np.asarray(renderer.buffer_rgba()), _key(axes, renderer)
        begun[key] = [axes.M.tobytes(), axes.bbox.bounds, axes._draw_grid, pixels.tobytes()]
        if key in last and last[key][:-1] == begun[key]:
            pixels[:] = last[key][-1]
            copied.add(axes)
        else:
            copied.discard(axes)

    def draw_pane(axis: Any, renderer: Any) -> None:
        if axis is axis.axes.xaxis:  # the first
            begin(axis.axes, renderer)
        if axis.axes not in copied:
            own["draw_pane"](axis, renderer)

    def draw_grid(axis: Any, renderer: Any) -> None:
        if axis.axes not in copied:
            own["draw_grid"](axis, renderer)

    def draw(axis: Any, renderer: Any) -> None:
        if axis.axes in copied:
            return
        own["draw"](axis, renderer)
        if axis is axis.axes.zaxis:  # the last
            key = _key(axis.axes, renderer)
            last[key] = [*begun[key], np.array(renderer.buffer_rgba())]

    with _replaced(Axis, {"draw_pane": draw_pane, "draw_grid": draw_grid, "draw": draw}):
        yield


@contextmanager
def undecorated() -> Iterator[None]:
    """Leave out the decoration of 3-D axes inside the ``with`` block, for a drawing that nobody sees."""
    from mpl_toolkits.mplot3d.axis3d import Axis

    with _replaced(Axis, dict.fromkeys(PARTS, lambda axis, renderer: None)):
        yield


@contextmanager
def _replaced(owner: Any, functions: Mapping[str, Any]) -> Iterator[None]:
    """Replace methods for the ``with`` block, or none of them if ``owner``, of another version of matplotlib,
    lacks one.
    """
    own = {name: getattr(owner, name, None) for name in functions}
    replaced = None not in own.values()
    try:
        for name, function in functions.items() if replaced else ():
            setattr(owner, name, function)
        yield
    finally:
        for name, former in own.items() if replaced else ():
            setattr(owner, name, former)


def _key(axes: Any, renderer: Any) -> tuple[Any, bool]:
    return axes, "draw_text" in vars(renderer)
