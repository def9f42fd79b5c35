"""Copies of the panes, grid lines and ticks of 3-D axes are those that matplotlib would draw."""

from contextlib import nullcontext

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.animation import FuncAnimation
from mpl_toolkits.mplot3d.axis3d import Axis

from polhode.animation import animate, animation_recording, draw_decoration_once
from polhode.animation.animation_recording import record

CHANGES = {
    "nothing": lambda axes, k: None,
    "the camera": lambda axes, k: axes.view_init(20.0, 40.0 * k),
    "the limits": lambda axes, k: axes.set_xlim(-1.0 - k, 1.0),
    "a label": lambda axes, k: axes.set_xlabel(f"x {k}"),
    "ticks": lambda axes, k: axes.set_yticks([0.0, 0.2 * k]),
    "their colour": lambda axes, k: axes.tick_params(colors=f"C{k}"),
    "a pane": lambda axes, k: axes.zaxis.pane.set_facecolor(f"C{k}"),
    "the grid": lambda axes, k: axes.grid(k % 2),
    "the title": lambda axes, k: axes.set_title(f"t = {k}"),
    "the background": lambda axes, k: axes.figure.set_facecolor(f"C{k}"),
    "all axes": lambda axes, k: axes.set_axis_on() if k % 2 else axes.set_axis_off(),
    "the size": lambda axes, k: axes.set_position([0.1, 0.1, 0.4 + 0.1 * k, 0.8]),
    "cleared axes": lambda axes, k: axes.cla(),
}
SOME = ("nothing", "the camera", "ticks", "cleared axes")  # the rest are slow tests


def animation(change, panels=2):
    figure = plt.figure(figsize=(4, 2))
    limits = {"xlim": (-1, 1), "ylim": (-1, 1), "zlim": (-1, 1)}
    every = [figure.add_subplot(1, panels, k + 1, projection="3d", **limits) for k in range(panels)]
    plt.close(figure)

    def update(k):
        change(every[0], k)
        for axes in every:
            axes.plot([0, 1], [0, np.cos(k)], [0, np.sin(k)])

    return FuncAnimation(figure, update, frames=5)


@pytest.mark.parametrize(
    "change",
    [
        pytest.param(CHANGES[name], marks=[] if name in SOME else [pytest.mark.slow], id=name)
        for name in CHANGES
    ],
)
def test_stills_are_those_without_copies(change, monkeypatch):
    copied = record(lambda: animation(change), 20.0)
    monkeypatch.setattr(animation_recording, "decorated_once", nullcontext)
    drawn = record(lambda: animation(change), 20.0)
    assert all(np.array_equal(copied[name], drawn[name]) for name in ("frames", "visible", "tracks"))


def test_the_drawing_that_blitting_begins_with_has_no_decoration(monkeypatch):
    drawings, own = [], Axis.draw
    monkeypatch.setattr(Axis, "draw", lambda axis, renderer: drawings.append(axis) or own(axis, renderer))
    figure = plt.figure()
    (line,) = figure.add_subplot(projection="3d").plot([0, 1], [0, 1], [0, 1])
    with animate.watched():
        FuncAnimation(figure, lambda k: [line], frames=3, blit=True)
    plt.close(figure)
    assert not drawings and figure.axes[0].M is not None


def test_decoration_that_stays_is_drawn_once_with_text_and_once_without(monkeypatch):
    drawings, own = [], Axis.draw
    monkeypatch.setattr(Axis, "draw", lambda axis, renderer: drawings.append(axis) or own(axis, renderer))
    record(lambda: animation(CHANGES["nothing"], panels=1), 20.0)
    assert len(drawings) == 2 * 3


def test_nothing_is_replaced_in_a_matplotlib_without_one_of_the_methods():
    class Axis:
        draw = "its own"

    with draw_decoration_once._replaced(Axis, {"draw_pane": "another", "draw": "another"}):
        assert Axis.draw == "its own" and not hasattr(Axis, "draw_pane")
    assert Axis.draw == "its own" and not hasattr(Axis, "draw_pane")
