import io
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from polhode.report.figure_files import contact_sheet
from service.grading.figures import rendering
from service.grading.grade import grade
from service.grading.submission import Submission


@pytest.fixture(scope="module")
def graded(rigid_body, sandbox):
    source = (rigid_body.folder / "samples" / "right_all.py").read_bytes()
    return grade(Submission.from_bytes(source, "right_all.py"), rigid_body, sandbox, 5)


def test_packed_arrays_are_read_as_they_were(graded):
    arrays = {"free": {"w": np.ones((3, 2)), "t": np.arange(2.0)}, "spin": {"w": np.zeros((3, 2))}}
    packed = rendering.pack(replace(graded, exercises=[], arrays=arrays))
    found = rendering.unpack(packed["arrays.npz"])
    assert {scene: its.keys() for scene, its in found.items()} == {s: a.keys() for s, a in arrays.items()}
    for scene, its in arrays.items():
        for name, array in its.items():
            assert np.array_equal(found[scene][name], array)


@pytest.mark.slow
def test_every_figure_of_the_report_can_be_drawn_and_has_its_alt_text(graded, rigid_body):
    packed = rendering.pack(graded)
    arrays = rendering.unpack(packed["arrays.npz"])
    assert len(graded.report.figures) == 8 and len(packed["arrays.npz"]) < 2_000_000
    for picture in graded.report.figures:
        figure = rendering.find(rigid_body, picture.name)
        svg = rendering.draw(rigid_body, figure, arrays, 5, "svg")
        assert svg == rendering.draw(rigid_body, figure, arrays, 5, "svg"), "drawn twice, the same bytes"
        assert picture.alt in svg.decode() and len(picture.alt) > 40
    png = rendering.draw(rigid_body, rendering.find(rigid_body, "omega-residual"), arrays, 5, "png")
    with Image.open(io.BytesIO(png)) as image:
        assert 900 <= image.size[0] < 960 and 450 <= image.size[1] < 520  # with a legend above the axes


def test_the_residual_has_a_log_axis_with_the_tolerance_in_it(rigid_body, graded):
    from matplotlib.figure import Figure

    from service.grading.sandbox_job import truth

    canvas = Figure()
    scene = rigid_body.scene("torque-free")
    rendering.find(rigid_body, "omega-residual").draw(
        canvas, [graded.arrays["torque-free"]], [truth(scene, scene.inputs)]
    )
    (axes,) = canvas.axes
    assert axes.get_yscale() == "log"
    assert any(abs(line.get_ydata()[0] - 1.01e-8 * np.sqrt(2)) < 1e-12 for line in axes.lines)


def drawn(rigid_body, name, arrays):
    """The axes of a figure that shows ``arrays`` by scene."""
    from matplotlib.figure import Figure

    from service.grading.sandbox_job import truth

    canvas, figure = Figure(), rendering.find(rigid_body, name)
    scenes = [rigid_body.scene(s) for s in figure.scenes]
    with np.errstate(all="ignore"):
        figure.draw(canvas, [arrays[s.name] for s in scenes], [truth(s, s.inputs) for s in scenes])
    return canvas.axes


def colours(axes):
    return {line.get_label(): line.get_color() for line in axes.lines if not line.get_label().startswith("_")}


def test_the_figures_show_what_the_courses_captions_say(rigid_body, graded):
    blue, orange, red, amber = "#0072b2", "#b36b00", "#c1272d", "#c0851a"
    solid, _ = drawn(rigid_body, "box", graded.arrays)
    assert [(text.get_text(), text.get_color()) for text in solid.texts] == [
        ("ê₁", amber),
        ("ê₂", blue),
        ("ê₃", red),
    ]
    left, right = drawn(rigid_body, "omega", graded.arrays)
    assert list(colours(left)) == ["ω₁", "ω₂", "ω₃", "exact"]
    T, _, L, _ = (line.get_ydata() for line in right.lines)
    assert (
        np.ptp(T) < 1e-11
        and np.ptp(L) < 1e-11
        and T[0] == pytest.approx(2.82)
        and L[0] == pytest.approx(4.180909)
    )
    (polhode,) = drawn(rigid_body, "polhode", graded.arrays)
    (ellipsoid,) = polhode.collections
    assert 0 < ellipsoid.get_alpha() < 0.5 and polhode.lines[0].get_color() == blue
    left, circle = drawn(rigid_body, "precession", graded.arrays)
    assert colours(left) == {"ω₁": blue, "ω₂": orange, "ω₃": red, "exact": "0.25"}
    assert circle.get_title().startswith("phase slope 1.8 rad/s")
    (cone,) = drawn(rigid_body, "cone", graded.arrays)
    found = colours(cone)
    assert [found[f"ê{k} at t = 0"] for k in "₁₂₃"] == [blue, orange, red]
    assert found["direction of L, fixed in space"] == "k"
    tip = np.array(cone.lines[0].get_data_3d())
    assert np.ptp(tip[2]) < 1e-9 and np.ptp(np.hypot(tip[0], tip[1])) < 1e-9, "a circle around the vertical"


def test_a_motion_that_diverges_leaves_the_exact_one_in_view(rigid_body, graded):
    grown = {s: dict(arrays) for s, arrays in graded.arrays.items() if {"t", "w"} <= arrays.keys()}
    for arrays in grown.values():
        late = np.maximum(arrays["t"] - 0.5 * arrays["t"][-1], 0)
        arrays["w"] = arrays["w"] * np.exp(80 * late / arrays["t"][-1])
    for name in ("omega", "precession"):
        for axes, right in zip(
            drawn(rigid_body, name, grown), drawn(rigid_body, name, graded.arrays), strict=True
        ):
            dotted = [line.get_ydata() for line in right.lines if line.get_linestyle() == "--"]
            exact = [ys for ys in dotted if len(ys)]  # without the legend's own line
            (least, most), room = axes.get_ylim(), 1.1 * max(np.abs(ys).max() for ys in exact)
            assert all(least <= ys.min() and ys.max() <= most for ys in exact) and most < 2 * room, name
            assert "yours leaves" in colours(axes) and "yours leaves" not in colours(right), name


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e300])
def test_a_figure_of_any_numbers_can_be_drawn(rigid_body, graded, value):
    for name in ("omega", "precession", "cone"):
        scenes = rendering.find(rigid_body, name).scenes
        spoilt = {
            s: {k: a if k == "t" else np.full_like(a, value) for k, a in graded.arrays[s].items()}
            for s in scenes
        }
        assert drawn(rigid_body, name, spoilt)


def test_contact_sheet_holds_the_stills_in_reading_order():
    frames = np.zeros((4, 5, 4, 3), np.uint8)
    for k in range(4):
        frames[k] = 10 * (k + 1)
    with Image.open(io.BytesIO(contact_sheet(frames))) as image:
        sheet = np.asarray(image)
    assert sheet.shape == (18, 24, 3)
    assert sheet[0, 0, 0] == 10 and sheet[0, 8, 0] == 20 and sheet[9, 0, 0] == 40 and sheet[9, 8, 0] == 255
