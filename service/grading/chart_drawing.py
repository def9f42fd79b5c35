"""Draw the charts of the reference methods as SVG: speed against accuracy, and where methods fail.

Charts are as wide as a phone, with 8 to 9 px text there. Curves have their names beside them, not in a
legend.
"""

import io
import math
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from ecp.outcome import SweptPoint

WIDE = 4.8  # inches
COLORS = (
    "#0060a8",
    "#b34700",
    "#00735a",
    "#a23b7a",
    "#6b5900",
)  # differ in lightness too, and can be read as text
GREY, FRONT, YOURS = "0.58", "#1a1a1a", "#c0006a"
STYLES = ("-", "--", ":", "-.")
MARKS = "osv^D<>"
FAMILIES = {
    "explicit": ("explicit",),
    "implicit": ("implicit",),
    "splitting": ("splitting",),
    "Lie group, MV: Moser-Veselov": ("Lie group", "Moser-Veselov"),
    "adaptive": ("adaptive",),
}
SHORT = {
    "RK8 (DOP853, fixed)": "RK8",
    "implicit midpoint": "midpoint",
    "Strang splitting": "Strang",
    "Euler angles (DOP853)": "Euler angles",
    "Moser-Veselov 2": "MV 2",
    "Moser-Veselov 4": "MV 4",
    "Moser-Veselov 6": "MV 6",
}
EXACT_ERROR = 1.5e-15  # largest error of R over the 2100 bodies of tests/reference/truth.npz
TOP_EXACT_ERROR = (
    5.1e-14  # largest error of R over 100 nutations of the tops of tests/reference/top_truth.npz
)
LEAST = 1e-17  # where a log axis shows zero
LEAST_S = 1e-6  # shorter times are shown as this one
GAP = 9.0  # points between two labels
ERROR_RANGE = (3e-16, 1e2)
APART = 1.2  # decades of the error between two labels of the front
XLABELS = {
    "periods": "periods of ω",
    "nudge": "nudge / spin",
    "angle": "turn per step / rad",
    "tilt": "least tilt from the vertical / rad",
    "ratio": "I₁, thinner rods to the left",
    "spin": "ω₃ / limit of the sleeping top",
}
CALLS = "evaluations of the right-hand side"
ATLAS: dict[
    str, tuple[str, dict[str, str], str]
] = {  # by entry: what varies, the columns shown with their names, the y label
    "energy drifts": ("periods", {"energy": ""}, "relative error of the energy"),
    "orthonormality is lost": ("periods", {"orthonormality": ""}, "largest |RᵀR − 1|"),
    "the wrong side of the separatrix": ("nudge", {"error": ""}, "relative error of ω"),
    "large steps blow up": ("angle", {"momentum": ""}, "relative error of |L|"),
    "gimbal lock": ("tilt", {"calls": "Euler angles", "matrix calls": "matrix form"}, CALLS),
    "gimbal lock of the heavy top": (
        "tilt",
        {"calls": "Euler angles", "matrix calls": "matrix form"},
        CALLS,
    ),
    "the sleeping top wakes": (
        "spin",
        {"largest tilt": "DOP853", "exact tilt": "exact"},
        "largest tilt / rad",
    ),
    "rods cost": ("ratio", {"calls": ""}, CALLS),
}
ERRORS = {"error": "ω", "energy": "energy", "momentum": "|L|", "orthonormality": "RᵀR − 1"}


def draw_work_precision(document: dict[str, Any], scene: str, yours: Sequence[SweptPoint] = ()) -> bytes:
    """Draw error against CPU time and against calls for one scene, log-log, as SVG. Add ``yours``, the points
    of a submission.

    A scene that the reference methods did not measure, such as another assignment's, shows ``yours`` alone.
    """
    return draw_class(document, scene, [yours], "yours")


@contextmanager
def _style() -> Iterator[None]:
    """Draw with the style of the charts inside the ``with`` block, or in the decorated function."""
    import matplotlib as mpl

    with mpl.rc_context({"font.size": 8.5, "axes.titlesize": 9, "axes.grid": True, "grid.alpha": 0.3}):
        yield


@_style()
def draw_class(
    document: dict[str, Any], scene: str, submissions: Sequence[Sequence[SweptPoint]], whose: str = "class"
) -> bytes:
    """Draw the same chart with the points of many submissions, of which each method has its mark, named in a
    key above.
    """
    points = [p for p in document["points"] if p["scene"] == scene]
    of_lines = {name: [p for p in points if p["line"] in lines] for name, lines in FAMILIES.items()}
    families = {name: found for name, found in of_lines.items() if found}
    rows = -(-len(families) // 2)
    canvas = _canvas(2 * 2.5 + 1.75 * rows)
    grid = canvas.add_gridspec(2 + rows, 2, height_ratios=[2.5, 2.5] + [1.6] * rows)
    by_time, by_calls = (canvas.add_subplot(grid[row, :]) for row in (0, 1))
    for axes, column in ((by_time, "ratio"), (by_calls, "calls")):
        for own in _methods(points).values():
            axes.loglog([p[column] for p in own], _errors(own, scene), color=GREY, marker=".", ms=3, lw=0.7)
        _draw_front(axes, points, scene, column)
        _draw_own(axes, submissions, column)
    relative = points or any(map(_unit_s, submissions))
    steps = any(p.step for own in submissions for p in own)
    label = "error at the end of the run, relative" if steps else "largest error over the run, relative"
    label = "largest error of ω or R" if points else label
    by_time.set(xlabel=f"CPU time / {'that of DOP853 at rtol 1e-11' if relative else 's'}")
    canvas.suptitle(scene, fontsize=9)
    by_calls.set(xlabel=CALLS)
    for axes in (by_time, by_calls):
        axes.set(ylim=ERROR_RANGE, ylabel=label)
        least, most = axes.get_xlim()
        axes.set_xlim(least / (most / least) ** 0.2, most)  # room for the names left of the front
    marks, methods = by_calls.get_legend_handles_labels()
    if methods:  # names beside the curves would cover each other where many submissions are alike
        names = [f"{whose}, {method}" for method in methods]
        by_time.legend(
            marks, names, ncols=2, loc="lower left", bbox_to_anchor=(0, 1), frameon=False, labelcolor=YOURS
        )
    for number, (name, own) in enumerate(families.items()):
        axes = canvas.add_subplot(grid[2 + number // 2, number % 2], sharey=by_time)
        axes.set_xlim(by_time.get_xlim())
        for other in _methods(points).values():
            axes.loglog([p["ratio"] for p in other], _errors(other, scene), color="0.88", lw=0.6)
        ends = []
        for (method, one), color in zip(_methods(own).items(), COLORS, strict=False):
            axes.loglog([p["ratio"] for p in one], _errors(one, scene), color=color, marker=".", ms=3, lw=1.2)
            ends.append((one[-1]["ratio"], _errors(one, scene)[-1], SHORT.get(method, method), color))
        axes.set(title=name, ylim=ERROR_RANGE)
        axes.label_outer()
        _label_ends(axes, ends)
    return svg(canvas, scene)


def front(points: Iterable[dict[str, Any]], column: str) -> list[dict[str, Any]]:
    """Return the Pareto front: the points than which no other is both at most as expensive and more accurate,
    cheapest first.

    ``column`` is the cost. The closed form and methods that diverged are left out.
    """
    found: list[dict[str, Any]] = []
    known = [p for p in points if p["line"] != "closed form" and error(p) is not None]
    for point in sorted(known, key=lambda p: (p[column], error(p))):
        if not found or (error(point) or 0.0) < (error(found[-1]) or 0.0):
            found.append(point)
    return found


def error(point: dict[str, Any]) -> float | None:
    """Return the larger of the two errors, or None if the method diverged."""
    both = [point["error_w"], point["error_R"]]
    return None if None in both else float(max(both))


@_style()
def draw_stability(document: dict[str, Any], number: int) -> bytes:
    """Draw one entry of the atlas as SVG: one quantity against what varies, the errors of one run, or the map
    of growth rates.
    """
    entry = document["entries"][number]
    rows = entry["rows"]
    if "predicted" in rows[0]:
        canvas = _canvas(6.0)
        _draw_growth_map(canvas, rows)
    elif entry["name"] in ATLAS:
        canvas = _canvas(3.0)
        _draw_against(canvas.subplots(), rows, *ATLAS[entry["name"]])
    else:
        canvas = _canvas(2.0)
        _draw_errors(canvas.subplots(), rows[0])
    return svg(canvas, entry["name"])


def svg(canvas: Any, title: str) -> bytes:
    """Return a figure as SVG, the same for the same figure."""
    import matplotlib as mpl

    stream = io.BytesIO()
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "polhode"}):
        canvas.savefig(stream, format="svg", metadata={"Title": title, "Date": None})
    return stream.getvalue()


def _canvas(high: float) -> Any:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    canvas = Figure(figsize=(WIDE, high), layout="constrained")
    FigureCanvasAgg(canvas)
    return canvas


def _methods(points: Iterable[dict[str, Any]]) -> dict[str, list[dict[str, Any]]]:
    """Return the steppers' points that did not diverge, by method."""
    found: dict[str, list[dict[str, Any]]] = {}
    for point in points:
        if point["line"] != "closed form" and error(point) is not None:
            found.setdefault(point["method"], []).append(point)
    return found


def _errors(points: Iterable[dict[str, Any]], scene: str) -> list[float]:
    """Return the errors. The closed form is the others' reference: its own error is against sixty digits."""
    exact = TOP_EXACT_ERROR if scene.startswith("heavy top") else EXACT_ERROR
    return [exact if p["line"] == "closed form" else max(error(p) or 0.0, LEAST) for p in points]


def _draw_front(axes: Any, points: list[dict[str, Any]], scene: str, column: str) -> None:
    """Draw the Pareto front of the steppers with the name of each method on it, and the closed form."""
    best = front(points, column)
    axes.loglog([p[column] for p in best], _errors(best, scene), color=FRONT, marker="o", ms=3.5, lw=1.6)
    ends, last = [], ""
    for point in best:
        if point["method"] != last:
            ends.append(
                (
                    point[column],
                    _errors([point], scene)[0],
                    SHORT.get(point["method"], point["method"]),
                    FRONT,
                )
            )
        last = point["method"]
    exact = [p for p in points if p["method"] == "exact"]
    for point in exact:
        axes.loglog([point[column]], _errors([point], scene), marker="*", ms=11, color=COLORS[0])
        axes.annotate(
            "exact",
            (point[column], _errors([point], scene)[0]),
            (6, 4),
            textcoords="offset points",
            color=COLORS[0],
        )
    free = float("inf")
    for x, y, name, color in ends:  # from above to below; left of the front nothing is drawn
        at = math.log10(y)
        if free - at >= APART and y <= ERROR_RANGE[1]:
            axes.annotate(
                name,
                (x, y),
                (-5, -2),
                textcoords="offset points",
                ha="right",
                va="top",
                color=color,
                fontsize=8,
            )
            free = at


def _draw_own(axes: Any, submissions: Sequence[Sequence[SweptPoint]], column: str) -> None:
    """Draw the points of submissions with open marks, a mark and a line style for each method.

    CPU time is relative to a submission's own run of the notebook's setting; steppers, which have no such
    run, have theirs in seconds.
    """
    size: dict[str, Any] = (
        {"ms": 3, "lw": 0.4, "alpha": 0.5} if len(submissions) > 1 else {"ms": 6, "lw": 1.4}
    )
    for number, method in enumerate(dict.fromkeys(p.method for swept in submissions for p in swept)):
        mark, line, label = MARKS[number % len(MARKS)], STYLES[number % len(STYLES)], method
        for swept in submissions:
            unit = _unit_s(swept) or (1.0 if all(p.step for p in swept) else None)
            points = [p for p in swept if p.method == method and p.error is not None]
            if not points or (column == "ratio" and not unit):
                continue
            costs = [
                float(p.calls) if column == "calls" else max(p.seconds, LEAST_S) / max(unit or 1.0, LEAST_S)
                for p in points
            ]
            errors = [max(p.error or 0.0, LEAST) for p in points]
            axes.loglog(costs, errors, color=YOURS, marker=mark, mfc="none", ls=line, label=label, **size)
            label = ""


def _unit_s(yours: Sequence[SweptPoint]) -> float | None:
    """Return the CPU seconds of a submission's run of the notebook's setting, None if it has no such run."""
    return next((p.seconds for p in yours if (p.method, p.rtol) == ("DOP853", 1e-11)), None)


def _label_ends(axes: Any, ends: list[tuple[float, float, str, str]]) -> None:
    """Write the name of each curve right of the axes, at the height of its end (x, y) or as near as the
    others let it.
    """
    height = axes.get_position().height * axes.figure.get_figheight() * 72
    (least, most), found = axes.get_ylim(), sorted((y, name, color) for _, y, name, color in ends)
    share = [math.log(min(max(y, least), most) / least) / math.log(most / least) for y, _, _ in found]
    places: list[float] = []
    for one in share:
        places.append(max(one * height, places[-1] + GAP if places else 0.0))
    for k in range(len(places) - 1, -1, -1):  # those that were pushed out of the axes, down again
        places[k] = min(places[k], places[k + 1] - GAP if k + 1 < len(places) else height)
    for place, (_, name, color) in zip(places, found, strict=True):
        axes.annotate(name, (1.0, place / height), (3, 0), xycoords="axes fraction",
            textcoords="offset points", color=color,
                      fontsize=8, va="center")  # fmt: skip


def _draw_against(
    axes: Any, rows: list[dict[str, Any]], varied: str, columns: dict[str, str], label: str
) -> None:
    """Draw the columns against what varies. A run that diverged is a cross at the upper edge."""
    series = list(dict.fromkeys((r.get("method", ""), r.get("setting")) for r in rows))
    ends, diverged = [], []
    curves = [(one, column, name) for one in series for column, name in columns.items()]
    for number, (one, column, name) in enumerate(curves):
        color, style = COLORS[number % len(COLORS)], STYLES[number if name else 0]
        own = sorted(
            (r for r in rows if (r.get("method", ""), r.get("setting")) == one), key=lambda r: r[varied]
        )
        points = [(r[varied], max(r[column], LEAST)) for r in own if r[column] is not None]
        text = name or one[0] + (f", {one[1]:g}" if one[1] else "")
        diverged += [(r[varied], color) for r in own if r[column] is None]
        if points:
            axes.loglog(*zip(*points, strict=True), marker=".", color=color, ls=style, lw=1.3)
            ends.append((*points[-1], text, color))
        else:
            ends.append((own[-1][varied], float("inf"), f"{text}: diverges", color))
    axes.set(xlabel=XLABELS[varied], ylabel=label)
    axes.set_xscale("log")
    axes.set_yscale("log")
    ticks = sorted({r[varied] for r in rows})
    if ticks[-1] < 100 * ticks[0]:  # the axis would have hardly a number of its own
        ticks = [tick for k, tick in enumerate(ticks) if not k or tick > 1.2 * ticks[k - 1]]
        axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
        axes.set_xticks([], minor=True)
    top = axes.get_ylim()[1]
    for x, color in diverged:
        axes.plot([x], [top], marker="x", color=color, ls="", clip_on=False)
    axes.set_ylim(top=top)
    _label_ends(axes, [(x, min(y, top), text, color) for x, y, text, color in ends])


def _draw_errors(axes: Any, row: dict[str, Any]) -> None:
    """Draw the errors of one run, each a line with its value."""
    for place, column in enumerate(reversed(ERRORS)):
        color = COLORS[1] if row[column] > 1e-6 else COLORS[0]
        axes.hlines(place, 1e-16, row[column], color=color, lw=5)
        axes.annotate(
            f"{row[column]:.1g}",
            (row[column], place),
            (5, 0),
            textcoords="offset points",
            va="center",
            color=color,
        )
    axes.set_xscale("log")
    axes.set_yticks(range(len(ERRORS)), [*ERRORS.values()][::-1])
    axes.set(xlim=(1e-16, 1e3), xlabel=f"relative error of {row['method']} after {row['periods']:g} periods")


def _draw_growth_map(canvas: Any, rows: list[dict[str, Any]]) -> None:
    against, where = canvas.subplots(2, 1)
    predicted, measured = ([r[name] for r in rows] for name in ("predicted", "measured"))
    against.plot([0, max(predicted)], [0, max(predicted)], color=GREY)
    against.plot(predicted, measured, ".", color=COLORS[0])
    against.set(xlabel="predicted growth rate σ / Ω", ylabel="measured σ / Ω")
    against.annotate(
        "equal",
        (max(predicted), max(predicted)),
        (-6, -2),
        textcoords="offset points",
        ha="right",
        color="0.35",
    )
    dots = where.scatter([r["I1"] for r in rows], [r["I2"] for r in rows], c=predicted, s=45)
    canvas.colorbar(dots, ax=where, label="predicted σ / Ω")
    where.set(xlabel="I₁ / I₃", ylabel="I₂ / I₃")
