"""Charts of submissions: milliseconds on this machine against the error, of one and of a class."""

import math
from collections.abc import Sequence

from polhode.judging.outcome import SweepResult, SweptPoint
from service.grading.figures.chart_drawing import COLORS, GHOST, Chart, Curve

DOUBLE, SINGLE = 2.0**-52, 2.0**-23
NOTEBOOKS = ("DOP853", 1e-11)
MS = 1e3
LEAST_S = 1e-6  # shorter times are shown as this one


def card(swept: SweepResult) -> Chart:
    """Return the chart of one submission, with the right solution as ghosts."""
    ghosts = _curves(swept.reference, [GHOST] * len(COLORS))
    names = [f"{ghost.name} of the solution" for ghost in ghosts]
    if not any(p.step for p in swept.points):  # solvers, whose names stand at the submission's curves
        names = [*[""] * (len(ghosts) - 1), "the solution"]
    named = [ghost._replace(name=name) for ghost, name in zip(ghosts, names, strict=False)]
    curves = [*_curves(swept.points, [*COLORS]), *named]
    levels = [(swept.tolerance, "tolerance of the check")] if swept.tolerance else []
    if swept.sensitivity:
        levels += [
            (swept.sensitivity * DOUBLE, "float64, κ·2⁻⁵²"),
            (swept.sensitivity * SINGLE, "float32, κ·2⁻²³"),
        ]
    walls = [(swept.closed_form * MS, "closed form")] if swept.closed_form else []
    rings = [
        (_ms(p), p.error, COLORS[0])
        for p in swept.points
        if (p.method, p.rtol) == NOTEBOOKS and p.error is not None
    ]
    return Chart(
        "CPU time / ms on this machine", _up(swept.points), swept.scene, curves, levels, walls, rings
    )


def of_class(scene: str, submissions: Sequence[Sequence[SweptPoint]]) -> Chart:
    """Return the chart of many submissions on one scene, each method in one colour."""
    methods = dict.fromkeys(p.method for points in submissions for p in points)
    colors, curves = dict(zip(methods, COLORS, strict=False)), []
    for points in submissions:
        for curve in _curves(points, [colors[name] for name in dict.fromkeys(p.method for p in points)]):
            curves.append(curve if methods.pop(curve.name, 0) is None else curve._replace(name=""))
    up = _up([p for points in submissions for p in points])
    return Chart("CPU time / ms on this machine", up, scene, curves)


def _curves(points: Sequence[SweptPoint], colors: Sequence[str]) -> list[Curve]:
    """Return one curve for each method; a run that diverged or was stopped is a cross."""
    of: dict[str, list[tuple[float, float]]] = {}
    for p in points:
        of.setdefault(p.method, []).append((_ms(p), math.inf if p.error is None else p.error))
    return [Curve(name, pairs, color) for (name, pairs), color in zip(of.items(), colors, strict=False)]


def _ms(point: SweptPoint) -> float:
    return max(point.seconds, LEAST_S) * MS


def _up(points: Sequence[SweptPoint]) -> str:
    steps = any(p.step for p in points)
    return "error at the end of the run, relative" if steps else "largest error over the run, relative"
