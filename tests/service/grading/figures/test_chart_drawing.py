"""Charts as SVG: names do not cover each other, nothing leaves the frame, and what diverges says so."""

import itertools
import math
import re
import xml.etree.ElementTree as ET

import pytest

from service.grading.figures import chart_drawing
from service.grading.figures.chart_drawing import (
    BOTTOM,
    GAP,
    HIGH,
    LEFT,
    RIGHT,
    TOP,
    WIDE,
    Chart,
    Curve,
    draw,
    number,
)


def drawn(*curves, **more):
    return draw(Chart("across", "up", "a <title>", curves, **more)).decode()


def test_a_chart_is_a_document_with_title_axes_and_names():
    svg = drawn(
        Curve("one & two", [(1.0, 1e-3), (10.0, 1e-6)], "c0"), levels=[(1e-5, "κ")], walls=[(3.0, "wall")]
    )
    words = [element.text for element in ET.fromstring(svg).iter("{http://www.w3.org/2000/svg}text")]
    assert {"across", "up", "one & two", "κ", "wall", "1e-6"} <= set(words)
    assert "a &lt;title&gt;" in svg and "light-dark" in svg


def test_every_point_lies_in_the_frame():
    points = [(1e-3, 1e-30), (1.0, 1e-3), (1e3, math.inf), (1e2, 9.9)]
    svg = drawn(Curve("c", points, "c0"), rings=[(1.0, 1e-3, "c0")])
    places = [(float(x), float(y)) for x, y in re.findall(r'<circle cx="([\d.]+)" cy="([\d.]+)"', svg)]
    assert len(places) == 4
    assert all(LEFT <= x <= WIDE - RIGHT and TOP <= y <= HIGH - BOTTOM for x, y in places)
    assert svg.count(">×<") == 1


def test_a_curve_that_diverges_everywhere_is_named():
    svg = drawn(
        Curve("Euler", [(1.0, math.inf), (2.0, math.inf)], "c0"),
        Curve("RK4", [(1.0, 1e-3), (2.0, 1e-5)], "c1"),
    )
    assert svg.count(">×<") == 2 and ">Euler<" in svg


def test_a_single_point_has_its_name_beside_it():
    svg = drawn(Curve("a", [(1.0, 1e-3)], "c0"), Curve("b", [(1e3, 1e-5)], "c1"))
    (x, text), _ = re.findall(r'<text x="([\d.]+)"[^>]*class="name c\d">(\w)<', svg)
    (dot,) = re.findall(r'<circle cx="([\d.]+)"[^>]*c0"', svg)
    assert text == "a" and 0 < float(x) - float(dot) < 10


@pytest.mark.parametrize("heights", [(100.0,) * 5, (0.0, 0.0, 240.0), (300.0,) * 3, (50.0, 10.0)])
def test_names_beside_curves_do_not_overlap_and_stay_at_the_axes(heights):
    places = chart_drawing._apart(sorted(heights))
    assert len(places) == len(heights) and places[0] >= 0 and places[-1] <= HIGH - BOTTOM
    assert all(b - a >= GAP for a, b in itertools.pairwise(places))


@pytest.mark.parametrize(
    ("value", "text"),
    [(1e-8, "1e-8"), (0.05, "0.05"), (1500.0, "1500"), (2.34e-7, "2.3e-7"), (1e5, "1e5"), (1.0, "1")],
)
def test_numbers_are_short(value, text):
    assert number(value) == text
