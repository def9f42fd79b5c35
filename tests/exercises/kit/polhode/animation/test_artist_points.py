"""What the kit sees of a drawing and of a function's parameters, and the check word with a scale."""

import time

import numpy as np
import pytest
from matplotlib.animation import Animation, FuncAnimation
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, Polygon
from matplotlib.transforms import Affine2D
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from polhode.animation import animate, animation_recording, artist_points
from polhode.judging import comparisons, return_value
from polhode.judging.return_value import WrongAnswer
from polhode.judging.verdict import Verdict


def test_takes_and_exchanged():
    names = ("t", "w", "I")
    return_value.check_signature(lambda t, w, I: 0, names, "f")
    return_value.check_signature(lambda *args: 0, names, "f")
    return_value.check_signature(lambda t, w, I, extra=1: 0, names, "f")
    return_value.check_signature(min, names, "f")  # has no signature
    with pytest.raises(
        WrongAnswer, match=r"the checks call `f\(t, w, I\)`, but yours is defined as `f\(w, I\)`: change"
    ) as caught:
        return_value.check_signature(lambda w, I: 0, names, "f")
    assert caught.value.code == "signature"
    assert return_value.exchanged(lambda w, t, I: 0, names) == "(w, t, I)"
    assert (
        return_value.exchanged(lambda t, w, I: 0, names) is None
        and return_value.exchanged(lambda a, b, c: 0, names) is None
    )


def _axes(three):
    figure = Figure()
    FigureCanvasAgg(figure)
    return figure, figure.add_subplot(projection="3d" if three else None)


def _arrow(axes):
    arrow = FancyArrowPatch((0, 0), (1, 2))
    axes.add_patch(arrow)


@pytest.mark.parametrize(
    ("three", "draw_it", "points"),
    [
        (True, lambda a: a.plot([0, 1], [0, 2], [0, 3]), [[0, 0, 0], [1, 2, 3]]),
        (True, lambda a: a.scatter([1], [2], [3]), [[1, 2, 3]]),
        (True, lambda a: a.quiver(0, 0, 0, 1, 2, 3), [[0, 0, 0], [1, 2, 3]]),
        (True, lambda a: a.add_collection3d(Poly3DCollection([np.eye(3)])), np.eye(3).tolist()),
        (False, lambda a: a.plot([0, 1], [0, 2]), [[0, 0, 0], [1, 2, 0]]),
        (False, lambda a: a.scatter([1], [2]), [[1, 2, 0]]),
        (False, lambda a: a.quiver(1, 1, 2, 3), [[1, 1, 0], [3, 4, 0]]),
        (False, lambda a: a.add_patch(Polygon([[0, 0], [1, 0], [1, 1]])), [[0, 0, 0], [1, 0, 0], [1, 1, 0]]),
        (False, _arrow, [[0, 0, 0], [1, 2, 0]]),
        (False, lambda a: a.annotate("", (1, 2), (0, 0)), [[0, 0, 0], [1, 2, 0]]),
        (False, lambda a: a.fill([0, 1, 1], [0, 0, 2]), [[0, 0, 0], [1, 0, 0], [1, 2, 0]]),
    ],
    ids=[
        "line3d",
        "scatter3d",
        "quiver3d",
        "poly3d",
        "line",
        "scatter",
        "quiver",
        "polygon",
        "arrow",
        "annotation",
        "fill",
    ],
)
def test_points_of_artists(three, draw_it, points):
    figure, axes = _axes(three)
    draw_it(axes)
    (found,) = artist_points.drawn(figure)
    assert found.dimensions == (3 if three else 2)
    for point in points:
        assert np.abs(found.points - point).sum(axis=1).min() < 1e-9, found.points


def test_hidden_artists_and_furniture_are_not_drawn():
    figure, axes = _axes(False)
    (line,) = axes.plot([0, 1], [0, 1])
    line.set_visible(False)
    axes.set_title("title")
    axes.grid()
    assert artist_points.drawn(figure) == []


@pytest.mark.slow
def test_a_trail_keeps_its_ends_and_an_arrow_drawn_anew_is_the_same_artist():
    figure, axes = _axes(True)

    def update(k):
        axes.cla()
        axes.plot([0, k], [0, 0], [0, 1])
        axes.plot(range(k + 2), range(k + 2), range(k + 2))
        axes.plot([], [], [])

    seen = animation_recording.watch(
        FuncAnimation(figure, update, frames=30, cache_frame_data=False), seconds=60.0
    )
    assert seen["at"][-1].tolist() == [29, 29, 30]
    tips = seen["tracks"][:, :, 0].T.tolist()
    assert [k + 1.0 for k in range(30)] in tips, "the last point of the trail"
    assert [float(k) for k in range(30)] in tips, "the tip of the line drawn anew"
    assert seen["cost"][0] == 30 and seen["cost"][2] > 0


def test_within():
    good = comparisons.within([1.0, 2.0], [1.0, 2.1], [1.0, 2.0], 0.06)
    assert (
        good.verdict is Verdict.PASS
        and good.detail == "max|Δ|/scale = 0.05 (limit 0.06)"
        and good.where == (1,)
    )
    assert comparisons.within([1.0, 2.0], [1.0, 2.1], 1.0, 0.06).verdict is Verdict.FAIL
    assert comparisons.within([1.0, np.nan], [1.0, 2.0], 1.0, 1.0).verdict is Verdict.FAIL
    assert comparisons.within([1.0], [1.0, 1.0], 1.0, 1.0).verdict is Verdict.FAIL, "nothing is broadcast"
    assert comparisons.within(1.0, [1.0], 1.0, 1.0).verdict is Verdict.FAIL
    assert comparisons.within([0.0], [0.0], 0.0, 1.0).verdict is Verdict.PASS
    assert comparisons.within([1e-9], [0.0], 0.0, 1.0).verdict is Verdict.FAIL, (
        "no allowance where there is no scale"
    )


@pytest.mark.slow
def test_frames_of_a_generator_are_drawn_as_they_come():
    figure, axes = _axes(False)
    (line,) = axes.plot([0, 1], [0, 0])

    def frames():
        for k in range(100):
            line.set_ydata([0, k])
            yield k

    seen = animation_recording.watch(
        FuncAnimation(figure, lambda k: (line,), frames=frames, save_count=100), seconds=60.0
    )
    assert len(seen["frames"]) == 6 and np.ptp(seen["tracks"], axis=0).max() > 90


def test_what_cannot_be_read_is_left_out():
    figure, axes = _axes(False)
    axes.plot([0, 1], [0, 1])
    axes.text(0.5, 0.5, "x").U = 3
    axes.annotate("L", xy=("a", 0.5), annotation_clip=False)
    assert [d.points.tolist() for d in artist_points.drawn(figure)] == [[[0, 0, 0], [1, 1, 0]]]
    assert artist_points.painted(figure) == 0
    axes.imshow(np.zeros((2, 2)))
    assert artist_points.painted(figure) == 1


def test_invisible_artists_and_logarithmic_axes_are_not_followed():
    figure, axes = _axes(False)
    axes.plot([0, 1], [0, 1], alpha=0.0)
    assert artist_points.drawn(figure) == []
    axes.plot([1, 2], [1, 2])
    axes.set_xscale("log")
    assert artist_points.drawn(figure) == [] and artist_points.painted(figure) == 1


def test_drawing_is_limited_in_cpu_time():
    figure, axes = _axes(False)
    (line,) = axes.plot([0, 1], [0, 0])

    def rest(k):
        time.sleep(0.02)
        line.set_ydata([0, k])

    def work(k):
        end = time.process_time() + 0.2
        while time.process_time() < end:
            pass

    began = time.process_time()
    animation_recording.watch(FuncAnimation(figure, rest, frames=12), seconds=60.0)
    drawing = time.process_time() - began
    animation_recording.watch(FuncAnimation(figure, rest, frames=12), seconds=drawing + 0.2)
    with pytest.raises(WrongAnswer, match=r"0\.1 s of CPU time were allowed"):
        animation_recording.watch(FuncAnimation(figure, work, frames=12), seconds=0.1)


def test_what_is_saved_or_rendered_is_kept_and_not_rendered(tmp_path):
    figure, _ = _axes(False)
    save = Animation.save
    with animate.watched():
        for render in (
            lambda anim: anim.save(tmp_path / "a.gif"),
            Animation.to_jshtml,
            Animation.to_html5_video,
            animate.show,
        ):
            animate.shown.clear()
            anim = FuncAnimation(figure, lambda k: (), frames=12)
            anim._draw_was_started = True  # or matplotlib warns that nobody looked at it
            render(anim)
            assert animate.shown == [anim]
    assert list(tmp_path.iterdir()) == [] and Animation.save is save


def test_polygons_of_changing_number_are_points_without_order():
    figure, ax = _axes(False)
    squares = np.array([[[0, 0], [1, 0], [1, 1], [0, 1]], [[1, 0], [2, 0], [2, 1], [1, 1]]], float)
    faces = ax.add_collection(PolyCollection([]))
    anim = FuncAnimation(
        figure, lambda k: faces.set_verts(squares[[k % 2]] + k if k % 3 else squares[::-1] + k), frames=12
    )
    seen = animation_recording.watch(anim, seconds=60.0)
    loose = seen["tracks"][:, seen["owners"][:, 1] == -2, :2]
    assert loose.shape == (12, 6, 2)
    for k, points in enumerate(loose):
        drawn = (squares[[k % 2]] if k % 3 else squares) + k
        assert {tuple(p) for p in points} == {tuple(p) for p in drawn.reshape(-1, 2)}


def test_labels_of_flat_axes_name_coordinates():
    figure = Figure()
    for k, (x, y) in enumerate(
        [("x", "$z$ [m]"), ("y-Achse", "Z (space)"), ("time t", "xy"), ("x'", "x_body"), ("", "$\\omega_x$")]
    ):
        figure.add_subplot(2, 3, k + 1, xlabel=x, ylabel=y)
    figure.add_subplot(2, 3, 6, projection="3d", xlabel="x", ylabel="y")
    expected = [[0, 0, 2], [1, 1, 2], [2, -1, -1], [3, -1, -1], [4, -1, -1]]
    assert artist_points.labelled(figure).tolist() == expected
    figure.add_subplot(projection="polar", xlabel="x", ylabel="y")
    assert artist_points.labelled(figure).tolist() == [*expected, [6, -2, -2]]
    assert artist_points.labelled(Figure()).tolist() == [[-1, -1, -1]]


def test_an_artist_with_a_transform_of_its_own_is_where_it_is_seen():
    figure = Figure()
    axes = figure.add_subplot()
    turned = Affine2D().rotate_deg(90).translate(1.0, 0.0) + axes.transData
    axes.plot([0.0, 2.0], [0.0, 0.0], transform=turned)
    axes.add_patch(Polygon([[0, 0], [2, 0], [2, 1]], transform=turned))
    lines, polygon = sorted((d for d in artist_points.drawn(figure)), key=lambda d: d.key[1])
    np.testing.assert_allclose(lines.points, [[1, 0, 0], [1, 2, 0]], atol=1e-12)
    np.testing.assert_allclose(polygon.points[[0, 2, 3]], [[1, 0, 0], [1, 2, 0], [0, 2, 0]], atol=1e-12)
