"""The kit as a notebook uses it."""

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.animation import ArtistAnimation, FuncAnimation
from matplotlib.figure import Figure

from ecp import animate, draw, film, validate
from ecp.strict import WrongAnswer, real_array

mpl.use("Agg")


def test_validate_prints_one_line_and_returns_a_bool(capsys):
    assert validate.close("a", 1.0, 1.0) is True
    assert validate.conserved("b", [1.0, 2.0]) is False
    assert validate.below("c", 3.0, 4.0) is True
    assert validate.positive("d", -1.0) is False
    assert validate.check("e", 1 < 2) is True
    assert capsys.readouterr().out.split("\n") == [
        "✓  a   [got 1 vs expected 1 (rtol=1e-06, atol=1e-09)]",
        "✗  b   [max relative drift = 1 (limit 1e-06)]",
        "✓  c   [got 3 (limit 4)]",
        "✗  d   [got -1 (must be > 0)]",
        "✓  e   [True]",
        "",
    ]


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
        ([True, False, True], "wrong-shape"),
        (np.array([1, 2, None]), "wrong-shape"),
    ],
)
def test_strict_refuses(value, code):
    with pytest.raises(WrongAnswer) as caught:
        real_array(value, (3,), "f")
    assert caught.value.code == code


@pytest.mark.parametrize("value", [[1, 2, 3], (1.0, 2.0, 3.0), np.array([1, 2, 3], dtype=np.float32)])
def test_strict_takes_any_three_real_numbers(value):
    assert real_array(value, (3,), "f").tolist() == [1.0, 2.0, 3.0]


def test_box_polys_are_the_faces_of_the_turned_box():
    half = np.array([1.0, 0.7, 0.2])
    faces = draw.box_polys(np.eye(3), half)
    assert faces.shape == (6, 4, 3)
    for k in range(6):
        assert set(faces[k][:, k // 2]) == {half[k // 2] * (1 - 2 * (k % 2))}
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    np.testing.assert_allclose(draw.box_polys(turn, half), faces @ turn.T)


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


@pytest.mark.parametrize("blit", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_stills_are_at_most_24_spread_over_all_frames_and_each_frame_is_computed_once(blit):
    anim, calls = _moving(100, blit=blit)
    calls.clear()
    stills = film.watch(anim, seconds=30.0)["frames"]
    assert stills.shape == (24, 360, 480, 3) and stills.dtype == np.uint8
    assert calls == [0, *range(100)]  # the first one is the initial draw
    assert film.moving_share(stills) > 1e-4


def test_stills_draw_each_still_once(monkeypatch):
    anim, _ = _moving(10)
    drawn, real = [], Figure.draw
    monkeypatch.setattr(Figure, "draw", lambda self, renderer: (drawn.append(1), real(self, renderer))[1])
    assert len(film.watch(anim, seconds=30.0)["frames"]) == len(drawn) == 10


def test_endless_animations_are_stopped():
    import itertools

    anim, _ = _moving(itertools.count())
    with pytest.raises(WrongAnswer, match="more than 600 frames") as caught:
        film.watch(anim, seconds=30.0)
    assert caught.value.code == "too-many-frames"
    for many in (601, range(601), [*range(601)]):
        anim, calls = _moving(many)
        calls.clear()
        with pytest.raises(WrongAnswer, match="more than 600 frames"):
            film.watch(anim, seconds=30.0)
        assert calls == [0], "a number of frames that is known beforehand costs no drawing"
    anim, _ = _moving(50)
    with pytest.raises(WrongAnswer, match="after 0 frames"):
        film.watch(anim, seconds=0.0)
    with pytest.raises(WrongAnswer, match="got NoneType"):
        film.watch(None, seconds=1.0)


def test_artist_animations_work_too():
    figure = Figure(figsize=(4, 3))
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    FigureCanvasAgg(figure)
    axes = figure.subplots()
    anim = ArtistAnimation(figure, [axes.plot([0, 1], [0, k]) for k in range(5)])
    stills = film.watch(anim, seconds=30.0)["frames"]
    assert len(stills) == 5 and film.moving_share(stills) > 1e-4


def test_show_outside_a_notebook_keeps_the_animation():
    marker = object()
    assert animate.show(marker) is marker and animate.shown[-1] is marker
