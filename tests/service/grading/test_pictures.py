import io

import numpy as np
import pytest
from PIL import Image

from ecp.drawing import contact_sheet
from service.grading import pictures
from service.grading.grade import grade
from service.grading.submission import Submission


@pytest.fixture(scope="module")
def graded(rigid_body, sandbox):
    source = (rigid_body.folder / "specimens" / "right_all.py").read_bytes()
    return grade(Submission.from_bytes(source, "right_all.py"), rigid_body, sandbox, 5)


def test_every_figure_of_the_report_can_be_drawn_and_has_its_alt_text(graded, rigid_body):
    packed = pictures.pack(graded)
    arrays = pictures.unpack(packed["arrays.npz"])
    assert len(graded.report.figures) == 8 and len(packed["arrays.npz"]) < 2_000_000
    for picture in graded.report.figures:
        figure = pictures.find(rigid_body, picture.name)
        svg = pictures.draw(rigid_body, figure, arrays, 5, "svg")
        assert svg == pictures.draw(rigid_body, figure, arrays, 5, "svg"), "drawn twice, the same bytes"
        assert picture.alt in svg.decode() and len(picture.alt) > 40
    png = pictures.draw(rigid_body, pictures.find(rigid_body, "omega-residual"), arrays, 5, "png")
    with Image.open(io.BytesIO(png)) as image:
        assert image.size == (900, 450)


def test_the_residual_has_a_log_axis_with_the_tolerance_in_it(rigid_body, graded):
    from matplotlib.figure import Figure

    from service.grading.grade import truth

    canvas = Figure()
    scene = rigid_body.scene("torque-free")
    pictures.find(rigid_body, "omega-residual").draw(canvas, [graded.arrays["torque-free"]], [truth(scene, scene.inputs)])
    (axes,) = canvas.axes
    assert axes.get_yscale() == "log"
    assert any(abs(line.get_ydata()[0] - 1.01e-8 * np.sqrt(2)) < 1e-12 for line in axes.lines)


def test_contact_sheet_holds_the_stills_in_reading_order():
    frames = np.zeros((7, 10, 8, 3), np.uint8)
    for k in range(7):
        frames[k] = 10 * (k + 1)
    with Image.open(io.BytesIO(contact_sheet(frames))) as image:
        sheet = np.asarray(image)
    assert sheet.shape == (18, 48, 3)
    assert sheet[0, 0, 0] == 10 and sheet[0, 8, 0] == 20 and sheet[9, 0, 0] == 70 and sheet[9, 8, 0] == 255
