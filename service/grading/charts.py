"""Measurements of the reference methods: files in CSV and JSON with their charts in SVG."""

import csv
import functools
import json
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Protocol, TypeVar

import numpy as np

from service.grading.chart_drawing import draw_stability, draw_work_precision, error
from service.grading.grade import versions

MEASURED = Path(__file__).parent / "measured"


class _Named(Protocol):
    @property
    def name(self) -> str: ...


N = TypeVar("N", bound=_Named)


def write_work_precision(names: list[str] | None, out: Path) -> Path:
    """Measure the scenes whose names contain one of ``names`` (None: all). Write work-precision.{csv,json}
    and an SVG per scene.

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
    """Return the elements whose names contain one of ``names`` (None: all). Raises ValueError if there is
    none.
    """
    chosen = [one for one in known if names is None or any(name in one.name for name in names)]
    if not chosen:
        raise ValueError(
            f"no scene matches {', '.join(names or [])}; available: {', '.join(one.name for one in known)}"
        )
    return chosen


@functools.cache
def load_work_precision() -> dict[str, Any]:
    """Return the work-precision measurement of this version."""
    document: dict[str, Any] = json.loads((MEASURED / "work-precision.json").read_text())
    return document


def scenes(document: dict[str, Any]) -> list[str]:
    """Return the names of the measured scenes, in order."""
    return list(dict.fromkeys(p["scene"] for p in document["points"]))


def accurate(document: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the steppers' points with an error of at most 1e-8."""
    return [
        p
        for p in document["points"]
        if p["line"] != "closed form" and error(p) is not None and (error(p) or 0.0) <= 1e-8
    ]


def cheaper(document: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the accurate points that cost less CPU time than the exact solution of their scene."""
    price = {p["scene"]: p["ratio"] for p in document["points"] if p["method"] == "exact"}
    return [p for p in accurate(document) if p["ratio"] < price[p["scene"]]]


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
    """Measure the atlas entries whose names contain one of ``names`` (None: all). Write stability.json, a CSV
    and an SVG per entry.

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
