"""The measurement of the reference methods: what accuracy costs, where methods fail, and the least model of a
scene.
"""

import functools
import json
import math
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from service.grading.figures.chart_drawing import COLORS, GHOST, Chart, Curve, draw
from service.grading.grade import versions

MEASURED = Path(__file__).parent / "measured" / "reference.json"
EXACT_ERROR = 1.5e-15  # largest error of R over the 2100 bodies of tests/reference/truth.npz
METHOD_COLORS = dict(
    zip(
        ("RK4", "RK8", "DOP853", "Strang splitting", "splitting 6", "Moser-Veselov 6", "Euler"),
        COLORS,
        strict=True,
    )
)
US = 1e6


def measure() -> dict[str, Any]:
    """Measure all scenes and pictures, printing what is being measured. It takes a minute or two and needs
    numba.
    """
    from reference.charts import cost, failures, simplest_model
    from reference.charts.scenes import SCENES

    scenes, pictures = [], []
    for scene in SCENES:
        print(f"measuring {scene.name} …", flush=True)
        floor, points = cost.floor(scene), cost.measure(scene)
        claims = cost.claims(points, floor)
        scenes.append({"name": scene.name, "floor": floor, "points": points, "claims": claims})
    for picture in failures.PICTURES:
        print(f"measuring {picture.title} …", flush=True)
        curves = {curve.name: curve for curve in picture.measure()}
        shown = {"title": picture.title, "across": picture.across, "up": picture.up}
        pictures.append({**shown, "curves": [*curves.values()], "claims": [*picture.claims(curves)]})
    document = {
        "measured_at": datetime.now(UTC).isoformat(timespec="seconds"),
        "versions": versions(),
        "scenes": scenes,
        "pictures": pictures,
        "unfailing": [*failures.unfailing()],
        "least": [*simplest_model.table()],
    }
    return json.loads(_text(document))


def _text(document: Mapping[str, Any]) -> str:
    """Return a measurement as JSON; Infinity is an error that is not finite, of a run that diverged."""
    return json.dumps(document, ensure_ascii=False, default=float)


@functools.cache
def load() -> dict[str, Any]:
    """Return the measurement of this version."""
    document: dict[str, Any] = json.loads(MEASURED.read_text(encoding="utf-8"))
    return document


def write(document: Mapping[str, Any], out: Path) -> None:
    """Write a measurement as reference.json, and its charts as SVG."""
    out.mkdir(parents=True, exist_ok=True)
    (out / "reference.json").write_text(_text(document) + "\n", encoding="utf-8")
    for kind in ("cost", "failure"):
        for number in range(count(document, kind)):
            (out / f"{kind}-{number}.svg").write_bytes(draw(chart(document, kind, number)))


def count(document: Mapping[str, Any], kind: str) -> int:
    """Return the number of charts of the kind "cost" or "failure"."""
    return len(document["scenes" if kind == "cost" else "pictures"])


def chart(document: Mapping[str, Any], kind: str, number: int) -> Chart:
    """Return chart ``number`` of the kind "cost", one for each scene, or "failure", one for each picture."""
    if kind == "cost":
        return _cost(document["scenes"][number])
    picture = document["pictures"][number]
    colors = iter(COLORS)
    curves = [
        Curve(name, [*zip(x, y, strict=True)], _color(name) or next(colors))
        for name, x, y in picture["curves"]
    ]
    return Chart(picture["across"], picture["up"], picture["title"], curves)


def _color(name: str) -> str | None:
    return GHOST if name.startswith("κ") else METHOD_COLORS.get(name)


def _cost(scene: Mapping[str, Any]) -> Chart:
    of: dict[str, list[Sequence[float]]] = {}
    for method, *point in scene["points"]:
        of.setdefault(method, []).append(point)
    closed, scipy = of.pop("closed form"), of.pop("DOP853 in SciPy")[0]
    of.pop("Euler")  # it is never the cheapest
    curves = [
        Curve(name, [(seconds * US, error) for _, error, _, seconds in points], METHOD_COLORS[name])
        for name, points in of.items()
    ]
    curves.append(Curve("closed form", [(point[3] * US, EXACT_ERROR) for point in closed], "c6"))
    ours = next(point for point in of["DOP853"] if point[0] == scipy[0])
    arrow = [(ours[3] * US, ours[1]), (scipy[3] * US, scipy[1])]
    curves.append(Curve(f"in SciPy: ×{scipy[3] / ours[3]:.0f}", arrow, GHOST))
    levels = (
        [(scene["floor"], "(κ + angle)·2⁻⁵²")] if scene["floor"] and math.isfinite(scene["floor"]) else []
    )
    return Chart("CPU time / µs", "largest error of ω or R over the run", scene["name"], curves, levels)
