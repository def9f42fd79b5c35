"""The kit as a notebook uses it."""

import itertools

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.animation import ArtistAnimation, FuncAnimation
from matplotlib.figure import Figure

from polhode.animation import animate, animation_recording
from polhode.judging.return_value import WrongAnswer, real_array
from polhode.report import figure_parts as draw

mpl.use("Agg")


@pytest.mark.parametrize(
    ("value", "code"),
    [
        (None, "returns-nothing"),
        ([1.0, 2.0], "wrong-shape"),
        (1.0, "wrong-shape"),
        ([[1.0, 2.0, 3.0]], "wrong-shape"),
        ([1.0, [2.0, 3.0]], "wrong-shape"),
        ("abc", "wrong-shape"),
        ([1j, 0, 0], "wrong-shape"),
        ([1, 2, complex(3, float("nan"))], "wrong-shape"),
        ([True, False, True], "wrong-shape"),
        (np.array([1, 2, None]), "wrong-shape"),
    ],
)
def test_strict_refuses(value, code):
    with pytest.raises(WrongAnswer) as caught:
        real_array(value, (3,), "f")
    assert caught.value.code == code


@pytest.mark.parametrize(
    "value", [[1, 2, 3], (1.0, 2.0, 3.0), np.array([1, 2, 3], dtype=np.float32), np.array([1, 2 - 0j, 3])]
)
def test_strict_takes_any_three_real_numbers(value):
    assert real_array(value, (3,), "f").tolist() == [1.0, 2.0, 3.0]


def test_box_polys_are_the_faces_of_the_turned_box_in_the_course_order():
    half = np.array([1.0, 0.7, 0.2])
    faces = draw.box_polys(np.eye(3), tuple(half))
    assert isinstance(faces, list) and [face.shape for face in faces] == [(4, 3)] * 6
    for face, (axis, side) in zip(faces, [(2, -1), (2, 1), (1, -1), (1, 1), (0, 1), (0, -1)], strict=True):
        assert set(face[:, axis]) == {side * half[axis]}
        edges = np.abs(np.diff(face, axis=0, append=face[:1]))
        assert np.count_nonzero(edges) == 4, "neighbouring corners share an edge"
    assert faces[0].tolist() == (half * [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1)]).tolist()
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    np.testing.assert_allclose(draw.box_polys(turn, half), np.array(faces) @ turn.T)


def _moving(frames, **options):
    figure = Figure(figsize=(4, 3))
    (line,) = figure.subplots().plot([0, 1], [0, 1])
    figure.axes[0].set_ylim(-1, 1)
    calls = []

    def update(k):
        calls.append(k)
        line.set_ydata([0, np.sin(k)])
        return (line,)

    from matplotlib.backends.backend_agg import FigureCanvasAgg

    FigureCanvasAgg(figure)
    return FuncAnimation(figure, update, frames=frames, cache_frame_data=False, **options), calls


@pytest.mark.slow
@pytest.mark.parametrize("blit", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_six_stills_are_spread_over_all_frames_and_each_frame_is_computed_once(blit):
    anim, calls = _moving(100, blit=blit)
    calls.clear()
    stills = animation_recording.watch(anim, seconds=30.0)["frames"]
    assert stills.shape == (6, 360, 480, 3) and stills.dtype == np.uint8
    assert calls == [0, *range(100)]  # the first one is the initial draw
    assert animation_recording.moving_share(stills) > 1e-4


def test_stills_draw_each_still_once(monkeypatch):
    anim, _ = _moving(10)
    drawn, real = [], Figure.draw
    monkeypatch.setattr(Figure, "draw", lambda self, renderer: (drawn.append(1), real(self, renderer))[1])
    assert len(animation_recording.watch(anim, seconds=30.0)["frames"]) == 6
    assert len(drawn) == 6 + 1 + 3, (
        "besides, a second frame to see that it moves, one without artists and two without text"
    )


@pytest.mark.slow
def test_endless_animations_are_stopped():
    anim, _ = _moving(itertools.count())
    with pytest.raises(WrongAnswer, match="more than 600 frames") as caught:
        animation_recording.watch(anim, seconds=30.0)
    assert caught.value.code == "too-many-frames"
    for many in (601, range(601), [*range(601)]):
        anim, calls = _moving(many)
        calls.clear()
        with pytest.raises(WrongAnswer, match="more than 600 frames"):
            animation_recording.watch(anim, seconds=30.0)
        assert calls == [0], "a number of frames that is known beforehand costs no drawing"
    anim, _ = _moving(50)
    with pytest.raises(WrongAnswer, match="after 0 frames"):
        animation_recording.watch(anim, seconds=0.0)
    with pytest.raises(WrongAnswer, match="got NoneType"):
        animation_recording.watch(None, seconds=1.0)


def test_artist_animations_work_too():
    figure = Figure(figsize=(4, 3))
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    FigureCanvasAgg(figure)
    axes = figure.subplots()
    anim = ArtistAnimation(figure, [axes.plot([0, 1], [0, k]) for k in range(5)])
    stills = animation_recording.watch(anim, seconds=30.0)["frames"]
    assert len(stills) == 5 and animation_recording.moving_share(stills) > 1e-4


@pytest.mark.parametrize("period", [5, 19, 24, 32, 48, 95])
@pytest.mark.parametrize("frames", [96, pytest.param(97, marks=pytest.mark.slow)])
@pytest.mark.parametrize("known", [True, False])
def test_a_periodic_motion_differs_in_the_stills(period, frames, known):
    anim, _ = _moving(frames if known else lambda: (k for k in range(frames)))
    (line,) = anim._fig.axes[0].lines
    anim._func = lambda k: line.set_ydata([0, np.sin(2 * np.pi * k / period)])
    assert animation_recording.moving_share(animation_recording.watch(anim, seconds=30.0)["frames"]) > 1e-4


def test_show_outside_a_notebook_keeps_the_animation():
    marker = object()
    assert animate.show(marker) is marker and animate.shown[-1] is marker
