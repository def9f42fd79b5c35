"""Which artists the recording follows: those that change a pixel, however thin, pale, small or seldom, and no
others.
"""

import numpy as np
import pytest
from matplotlib.animation import FuncAnimation
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from mpl_toolkits.mplot3d.art3d import Line3D

from polhode.animation import animation_recording

FRAMES = 20
TIPS = np.array([[np.cos(a), np.sin(a), 0.5] for a in np.linspace(0.1, 5.0, FRAMES)])


def _film(update, three=False):
    figure = Figure()
    FigureCanvasAgg(figure)
    limits = {"xlim": (-1.2, 1.2), "ylim": (-1.2, 1.2)} | ({"zlim": (-1.2, 1.2)} if three else {})
    axes = figure.add_subplot(projection="3d" if three else None, **limits)
    change = update(figure, axes)
    return animation_recording.watch(
        FuncAnimation(figure, change, frames=FRAMES, cache_frame_data=False), seconds=60.0
    )


def _line(three=False, before=lambda figure, axes: None, **style):
    def update(figure, axes):
        before(figure, axes)
        (line,) = axes.plot(*[[]] * (3 if three else 2), **style)

        def change(k):
            x, y, z = ([0, c] for c in TIPS[k])
            line.set_data_3d(x, y, z) if three else line.set_data(x, y)
            axes.set_title(f"frame {k}")

        return change

    return _film(update, three)


def _moving(seen):
    return np.ptp(seen["tracks"], axis=0).max() > 0.5


def _away(figure, axes):
    axes.set(xlim=(5, 6), ylim=(5, 6))


def _sheet(figure, axes):
    axes.add_patch(Rectangle((-2, -2), 4, 4, color="w", zorder=9))


def _axes_in_front(figure, axes):
    figure.add_axes([0, 0, 1, 1], zorder=9).plot([0, 1], [0, 1])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("before", "style"),
    [
        (None, {"linestyle": "none"}),
        (None, {"color": "none"}),
        (None, {"lw": 0}),
        (None, {"color": "w", "zorder": 0.4}),
        (None, {"color": (0, 0, 0, 0)}),
        (None, {"alpha": 0.002}),
        (_away, {}),
        (_sheet, {}),
        (_axes_in_front, {}),
    ],
    ids=[
        "no style",
        "no colour",
        "no width",
        "white",
        "transparent",
        "nearly transparent",
        "elsewhere",
        "covered",
        "behind axes",
    ],
)
def test_what_changes_no_pixel_does_not_count(before, style):
    seen = _line(before=before or (lambda figure, axes: None), **style)
    assert not _moving(seen) and seen["visible"][1] == 1
    assert seen["visible"][0] == 0 or style == {"alpha": 0.002}, "only the title changes"


@pytest.mark.slow
@pytest.mark.parametrize("three", [False, True], ids=["2-D", "3-D"])
@pytest.mark.parametrize(
    "style",
    [
        {"lw": 0.5},
        {"color": "lightyellow", "lw": 0.5},
        {"alpha": 0.1, "lw": 0.5},
        {"linestyle": "none", "marker": ".", "ms": 1},
        {"linestyle": ":", "lw": 0.5},
    ],
    ids=["thin", "pale", "translucent", "small", "dotted"],
)
def test_what_can_hardly_be_seen_counts(three, style):
    seen = _line(three, **style)
    assert _moving(seen) and seen["visible"][0] > 0 and seen["visible"][1] == 0


def test_an_artist_partly_outside_the_limits_counts():
    seen = _line(before=lambda figure, axes: axes.set(xlim=(0.5, 0.6), ylim=(0.5, 0.6)))
    assert _moving(seen) and seen["visible"][1] == 0


def test_an_artist_that_appears_late_counts():
    def update(figure, axes):
        sheet = axes.add_patch(Rectangle((-2, -2), 4, 4, color="c", zorder=9))
        (line,) = axes.plot([], [])

        def change(k):
            line.set_data([0, TIPS[k, 0]], [0, TIPS[k, 1]])
            sheet.set_x(-2 if k < 12 else 0.3)

        return change

    assert _moving(_film(update))


@pytest.mark.slow
def test_a_white_line_on_a_coloured_disc_counts_with_the_axes_cleared_in_every_frame():
    def update(figure, axes):
        def change(k):
            axes.cla()
            axes.set(xlim=(-2, 2), ylim=(-2, 2))
            axes.fill(1.2 * TIPS[:, 0], 1.2 * TIPS[:, 1], "navy", zorder=1)
            axes.plot([0, TIPS[k, 0] / 2], [0, TIPS[k, 1] / 2], "w", zorder=2)
            axes.plot([0, -TIPS[k, 0] / 3], [0, -TIPS[k, 1] / 3], "k", zorder=0)

        return change

    seen = _film(update)
    assert _moving(seen) and seen["visible"][1] == 1, "the black line is behind the disc"


class _NeverDrawn(Line3D):
    def draw(self, renderer):
        pass


def test_only_the_visible_one_of_two_artists_is_followed_and_all_are_shown_again():
    kept = []

    def update(figure, axes):
        (visible,) = axes.plot([], [], [], "b")
        kept.extend([visible, _NeverDrawn([0, 0], [0, 0], [0, 1])])
        axes.add_line(kept[1])

        def change(k):
            visible.set_data_3d(*zip((0, 0, 0), TIPS[k], strict=True))
            kept[1].set_data_3d(*zip((0, 0, 0), 3 * TIPS[k], strict=True))

        return change

    seen = _film(update, three=True)
    assert 0.5 < np.ptp(seen["tracks"], axis=0).max() < 2.5
    assert seen["visible"][1] == 1 and all(artist.get_visible() for artist in kept)
