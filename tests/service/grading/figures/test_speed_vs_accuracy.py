"""Charts of submissions: absolute milliseconds, the solution as ghosts, and what was stopped as a cross."""

import re

from polhode.judging.outcome import SweepResult, SweptPoint
from service.grading.figures.chart_drawing import draw
from service.grading.figures.speed_vs_accuracy import card, of_class


def points(scale, stopped=False):
    return [
        SweptPoint("DOP853", 1e-5, 500, 1e-6, 0.01 * scale),
        SweptPoint("DOP853", 1e-11, 1697, 1e-11, 0.02 * scale),
        SweptPoint("LSODA", 1e-5, 400, 1e-4, 0.005 * scale),
        SweptPoint("LSODA", 1e-11, 40_001, None if stopped else 1e-9, 0.02 * scale, stopped=stopped),
    ]


def test_a_slow_function_is_drawn_slower_than_a_fast_one():
    """Formerly both were divided by their own time, so that they lay on top of each other."""
    fast, slow = (card(SweepResult("exercise 2", points(scale), "")) for scale in (1, 66))
    assert slow.curves[0].points[0][0] == 66 * fast.curves[0].points[0][0] == 660.0
    assert "ms" in fast.across and fast.rings == [(20.0, 1e-11, "c0")]


def test_the_solution_is_a_ghost_with_one_name_and_the_lines_have_theirs():
    swept = SweepResult("s", points(1, stopped=True), "", points(0.1), [], 1e-8, 72.7, 1e-4)
    svg = draw(card(swept)).decode()
    assert svg.count(">the solution<") == 1 and svg.count("curve ghost") == 2
    for name in (
        "DOP853",
        "LSODA",
        "tolerance of the check",
        "float64, κ·2⁻⁵²",
        "float32, κ·2⁻²³",
        "closed form",
    ):
        assert svg.count(f">{name}<") == 1, name
    assert svg.count(">×<") == 1


def test_a_class_names_each_method_once_in_one_colour():
    svg = draw(of_class("s", [points(1), points(2)[:2], points(3)[2:]])).decode()
    assert [svg.count(f">{name}<") for name in ("DOP853", "LSODA")] == [1, 1]
    assert re.findall(r'class="curve (c\d)"', svg) == ["c0", "c1", "c0", "c1"]
