"""Charts of the reference methods: measurement, files in CSV, JSON and SVG, and drawing from such a file."""

import csv
import functools
import io
import json
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Protocol, TypeVar

import numpy as np

from ecp.outcome import SweptPoint
from service.grading.grade import versions

MEASURED = Path(__file__).parent / "measured"
LINES = {
    "explicit": "#d55e00",
    "implicit": "#0072b2",
    "splitting": "#009e73",
    "Lie group": "#cc79a7",
    "Moser-Veselov": "#56b4e9",
    "adaptive": "#666666",
    "closed form": "#000000",
}
MARKS = "osv^D<>"
YOURS = "#e6007e"
AXES = {
    "periods": "periods of ω",
    "nudge": "nudge / spin",
    "angle": "turn per step / rad",
    "tilt": "tilt from the vertical / rad",
    "ratio": "I₁",
    "spin": "ω₃ / limit of the sleeping top",
}
COLUMNS = (["calls", "matrix calls"], ["largest tilt", "exact tilt"], ["error", "energy", "orthonormality", "momentum"])
SHOWN = {"error": "error of ω"}
STYLES = ("-", "--", ":", "-.")
EXACT_ERROR = 1.5e-15  # largest error of R over the 2100 bodies of tests/reference/truth.npz
TOP_EXACT_ERROR = 5.1e-14  # largest error of R over 100 nutations of the tops of tests/reference/top_truth.npz
LEAST = 1e-17  # where a log axis shows zero
LEAST_S = 1e-6  # shorter times are shown as this one


class _Named(Protocol):
    @property
    def name(self) -> str: ...


N = TypeVar("N", bound=_Named)


def write_work_precision(names: list[str] | None, out: Path) -> Path:
    """Measure the scenes whose names contain one of ``names`` (None: all). Write work-precision.{csv,json} and an SVG per scene.

    Raises ValueError if no scene matches.
    """
    from reference.work_precision import SCENES, measure, rows

    found = []
    for scene in _named(SCENES, names):
        print(f"measuring {scene.name} …", flush=True)
        found += rows(measure([scene]))
    document = _write_document(out / "work-precision.json", points=found)
    _write_csv(out / "work-precision.csv", found)
    for number, name in enumerate(scenes(document)):
        (out / f"work-precision-{number}.svg").write_bytes(draw_work_precision(document, name))
    return out


def _named(known: Sequence[N], names: list[str] | None) -> list[N]:
    """Return the elements whose names contain one of ``names`` (None: all). Raises ValueError if there is none."""
    chosen = [one for one in known if names is None or any(name in one.name for name in names)]
    if not chosen:
        raise ValueError(f"no scene matches {', '.join(names or [])}; available: {', '.join(one.name for one in known)}")
    return chosen


@functools.cache
def load_work_precision() -> dict[str, Any]:
    """Return the work-precision measurement of this version."""
    document: dict[str, Any] = json.loads((MEASURED / "work-precision.json").read_text())
    return document


def scenes(document: dict[str, Any]) -> list[str]:
    """Return the names of the measured scenes, in order."""
    return list(dict.fromkeys(p["scene"] for p in document["points"]))


def exceptions(document: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the points with an error of at most 1e-8 that cost less CPU time than the exact solution of their scene."""
    price = {p["scene"]: p["ratio"] for p in document["points"] if p["method"] == "exact"}
    return [
        p
        for p in document["points"]
        if p["line"] != "closed form" and _error(p) is not None and (_error(p) or 0.0) <= 1e-8 and p["ratio"] < price[p["scene"]]
    ]


def draw_work_precision(document: dict[str, Any], scene: str, yours: Sequence[SweptPoint] = ()) -> bytes:
    """Draw error against calls and against CPU time for one scene, log-log, as SVG. Add ``yours``, the points of a submission.

    A scene that the reference methods did not measure, such as another assignment's, shows ``yours`` alone.
    """
    return draw_class(document, scene, [yours], "yours")


def draw_class(document: dict[str, Any], scene: str, submissions: Sequence[Sequence[SweptPoint]], whose: str = "class") -> bytes:
    """Draw the same chart with the points of many submissions."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    canvas = Figure(figsize=(12, 5.2))
    FigureCanvasAgg(canvas)
    by_calls, by_time = canvas.subplots(1, 2, sharey=True)
    points = [p for p in document["points"] if p["scene"] == scene]
    used: dict[str, int] = {}
    for method in dict.fromkeys(p["method"] for p in points):
        drawn = [p for p in points if p["method"] == method and _error(p) is not None]
        if not drawn:
            continue
        line = drawn[0]["line"]
        mark = MARKS[used.setdefault(line, 0) % len(MARKS)]
        used[line] += 1
        style: dict[str, Any] = {"color": LINES[line], "marker": mark, "ms": 4, "lw": 1, "label": method}
        errors = [max(_error(p) or 0.0, LEAST) for p in drawn]
        if line == "closed form":  # the reference for the others; its own error is against sixty digits
            style |= {"marker": "*" if method == "exact" else "P", "ms": 12, "ls": ""}
            errors = [TOP_EXACT_ERROR if scene.startswith("heavy top") else EXACT_ERROR]
        by_calls.loglog([p["calls"] for p in drawn], errors, **style)
        by_time.loglog([p["ratio"] for p in drawn], errors, **style)
    for number, own in enumerate(submissions):
        _draw_own((by_calls, by_time), own, whose if number == 0 else "", small=len(submissions) > 1)
    error = f"largest error over the run, {'ω relative or R' if points else 'relative'}"
    if any(p.step for own in submissions for p in own):
        error = "error at the end of the run, relative"
    by_calls.set(xlabel="evaluations of the right-hand side", ylabel=error, title=scene)
    unit = "that of DOP853 at rtol 1e-11" if points or any(map(_unit_s, submissions)) else "s"
    by_time.set(xlabel=f"CPU time / {unit}", ylim=(3e-16, 1e2))
    by_time.legend(fontsize=7, bbox_to_anchor=(1.01, 1.0), loc="upper left")
    for axes in (by_calls, by_time):
        axes.grid(alpha=0.3)
    canvas.subplots_adjust(left=0.07, right=0.83, bottom=0.12, top=0.92, wspace=0.06)
    return svg(canvas, scene)


def _draw_own(axes: tuple[Any, Any], yours: Sequence[SweptPoint], whose: str, *, small: bool) -> None:
    """Draw the points of a submission with open marks.

    CPU time is relative to its own run of the notebook's setting; steppers, which have no such run, have theirs in seconds.
    """
    by_calls, by_time = axes
    unit = _unit_s(yours) or (1.0 if all(p.step for p in yours) else None)
    for number, method in enumerate(dict.fromkeys(p.method for p in yours)):
        points = [p for p in yours if p.method == method and p.error is not None]
        errors = [max(p.error or 0.0, LEAST) for p in points]
        style: dict[str, Any] = {
            "color": YOURS,
            "marker": MARKS[number % len(MARKS)],
            "mfc": "none",
            "ls": STYLES[number % len(STYLES)],
        }
        style |= {"ms": 5, "lw": 0.5, "alpha": 0.5} if small else {"ms": 9, "lw": 1.6}
        by_calls.loglog([p.calls for p in points], errors, **style)
        if unit:
            times = [max(p.seconds, LEAST_S) / max(unit, LEAST_S) for p in points]
            by_time.loglog(times, errors, label=f"{whose}, {method}" if whose else None, **style)


def _unit_s(yours: Sequence[SweptPoint]) -> float | None:
    """Return the CPU seconds of a submission's run of the notebook's setting, None if it has no such run."""
    return next((p.seconds for p in yours if (p.method, p.rtol) == ("DOP853", 1e-11)), None)


def _error(point: dict[str, Any]) -> float | None:
    """Return the larger of the two errors, or None if the method diverged."""
    both = [point["error_w"], point["error_R"]]
    return None if None in both else float(max(both))


def _write_document(path: Path, **measured: Any) -> dict[str, Any]:
    """Write a measurement with date and versions as JSON, and return it."""
    document: dict[str, Any] = _finite(
        {"measured_at": datetime.now(UTC).isoformat(timespec="seconds"), "versions": versions(), **measured}
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(document, ensure_ascii=False, indent=0))
    return document


def _write_csv(path: Path, rows: list[dict[str, Any]]) -> None:
    """Write one line per row, with a column for every name that any row has."""
    with path.open("w", newline="") as stream:
        writer = csv.DictWriter(stream, list(dict.fromkeys(k for row in rows for k in row)))
        writer.writeheader()
        writer.writerows(rows)


def _finite(value: Any) -> Any:
    """Return a value that JSON can represent: numbers that are not finite become None."""
    if isinstance(value, dict):
        return {k: _finite(v) for k, v in value.items()}
    if isinstance(value, Iterable) and not isinstance(value, str):
        return [_finite(v) for v in value]
    return None if isinstance(value, float) and not np.isfinite(value) else value


def write_stability(names: list[str] | None, out: Path) -> Path:
    """Measure the atlas entries whose names contain one of ``names`` (None: all). Write stability.json, a CSV and an SVG per entry.

    Raises ValueError if no entry matches.
    """
    from reference.stability_atlas import ATLAS

    entries = []
    for entry in _named(ATLAS, names):
        print(f"measuring: {entry.name} …", flush=True)
        rows = entry.measure()
        entries.append({"name": entry.name, "claim": entry.claim, "holds": entry.holds(rows), "rows": rows})
    document = _write_document(out / "stability.json", entries=entries)
    for number, entry in enumerate(document["entries"]):
        _write_csv(out / f"stability-{number}.csv", entry["rows"])
        (out / f"stability-{number}.svg").write_bytes(draw_stability(document, number))
    return out


@functools.cache
def load_stability() -> dict[str, Any]:
    """Return the stability atlas of this version."""
    document: dict[str, Any] = json.loads((MEASURED / "stability.json").read_text())
    return document


def draw_stability(document: dict[str, Any], number: int) -> bytes:
    """Draw one entry of the atlas as SVG: its numbers against the varied quantity, or the map of growth rates."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    entry = document["entries"][number]
    rows = entry["rows"]
    canvas = Figure(figsize=(9, 4.2))
    FigureCanvasAgg(canvas)
    if "predicted" in rows[0]:
        _draw_growth_map(canvas, rows)
    else:
        _draw_against(canvas.subplots(), rows)
    return svg(canvas, entry["name"])


def _draw_against(axes: Any, rows: list[dict[str, Any]]) -> None:
    varied = next(name for name in AXES if name in rows[0])
    shown = next((names for names in COLUMNS if names[0] in rows[0]), [])
    series = list(dict.fromkeys((r.get("method", "Euler's angles"), r.get("setting")) for r in rows))
    for index, (method, setting) in enumerate(series):
        own = [r for r in rows if (r.get("method", "Euler's angles"), r.get("setting")) == (method, setting)]
        for style, name in zip(STYLES, [n for n in shown if n in own[0]], strict=False):
            points = [(r[varied], max(r[name], LEAST)) for r in own if r[name] is not None]
            label = f"{method}{f' {setting:g}' if setting else ''}: {SHOWN.get(name, name)}"
            axes.loglog([x for x, _ in points], [y for _, y in points], style, marker=".", color=f"C{index}", lw=1, label=label)
    axes.set(xlabel=AXES[varied])
    axes.grid(alpha=0.3)
    axes.legend(fontsize=7, bbox_to_anchor=(1.01, 1.0), loc="upper left")
    axes.figure.subplots_adjust(right=0.68, bottom=0.13)


def _draw_growth_map(canvas: Any, rows: list[dict[str, Any]]) -> None:
    where, against = canvas.subplots(1, 2)
    predicted, measured = ([r[name] for r in rows] for name in ("predicted", "measured"))
    dots = where.scatter([r["I1"] for r in rows], [r["I2"] for r in rows], c=predicted, s=60)
    canvas.colorbar(dots, ax=where, label="σ / Ω predicted")
    where.set(xlabel="I₁ / I₃", ylabel="I₂ / I₃")
    against.plot([0, max(predicted)], [0, max(predicted)], color="0.7")
    against.plot(predicted, measured, ".")
    against.set(xlabel="σ / Ω predicted", ylabel="σ / Ω measured")
    canvas.subplots_adjust(wspace=0.35, bottom=0.13)


def svg(canvas: Any, title: str) -> bytes:
    """Return a figure as SVG, the same for the same figure."""
    import matplotlib as mpl

    stream = io.BytesIO()
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "polhode"}):
        canvas.savefig(stream, format="svg", metadata={"Title": title, "Date": None})
    return stream.getvalue()
