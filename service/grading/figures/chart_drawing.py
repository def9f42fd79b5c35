"""Log-log charts as SVG files: named curves, levels, walls and rings, legible on a phone and in dark mode."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from markupsafe import Markup

WIDE, HIGH = 390, 260  # view box; about a pixel a unit on a phone
LEFT, RIGHT, TOP, BOTTOM = 40, 104, 28, 34
GAP = 11.0  # between two names
LEAST, MOST = 1e-17, 1e1  # errors outside are drawn at the edge
LABELS = 6
COLORS = ("c0", "c1", "c2", "c3", "c4", "c5", "c6")
GHOST = "ghost"
STYLE = Markup("""
svg { color-scheme: light dark; background: light-dark(#fff, #191c21); color: light-dark(#1b1f24, #e6e8eb);
font: 11px system-ui, sans-serif; fill: currentcolor; --quiet: light-dark(#545c66, #a6adb7); }
text { paint-order: stroke; stroke: light-dark(#fff, #191c21); stroke-width: 2.5px; }
.quiet { fill: var(--quiet); } .middle { text-anchor: middle; } .end { text-anchor: end; }
.grid { stroke: light-dark(#d9dde3, #363b44); } .level { stroke: var(--quiet); stroke-dasharray: 5 3; }
.curve { fill: none; stroke: var(--c); stroke-width: 1.6; } .dot, .name { fill: var(--c); }
.ring { fill: none; stroke: var(--c); stroke-width: 1.4; }
.ghost { --c: var(--quiet); } .curve.ghost { stroke-width: 1; stroke-dasharray: 2 2; }
.c0 { --c: light-dark(#0060a8, #69b3ff); } .c1 { --c: light-dark(#b34700, #ff9d5c); }
.c2 { --c: light-dark(#00735a, #4fd1a5); } .c3 { --c: light-dark(#a23b7a, #f08cc6); }
.c4 { --c: light-dark(#6b5900, #d8c04a); } .c5 { --c: light-dark(#5a4fb0, #b3a8ff); }
.c6 { --c: light-dark(#1b1f24, #e6e8eb); }
""")
_SVG = Markup(
    '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0} {1}" width="{0}" height="{1}">'
    "<title>{2}</title><style>{3}</style>{4}</svg>"
)
_TEXT = Markup('<text x="{:.1f}" y="{:.1f}" class="{}">{}</text>')
_LINE = Markup('<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}" class="{}"/>')
_PATH = Markup('<path d="{}" class="curve {}"/>')
_CIRCLE = Markup('<circle cx="{:.1f}" cy="{:.1f}" r="{}" class="{} {}"/>')
Pairs = Sequence[tuple[float, float]]


class Curve(NamedTuple):
    """A named curve through ``points`` (x, y); a y that is infinite is a cross at the upper edge."""

    name: str
    points: Pairs
    color: str


@dataclass(frozen=True)
class Chart:
    """A log-log chart: the axes' names, its title, and its marks.

    ``levels`` are horizontal lines and ``walls`` vertical ones, each with its name; ``rings`` mark points.
    """

    across: str
    up: str
    title: str
    curves: Sequence[Curve]
    levels: Sequence[tuple[float, str]] = ()
    walls: Sequence[tuple[float, str]] = ()
    rings: Sequence[tuple[float, float, str]] = ()


class _Axis:
    """A logarithmic scale from ``start`` to ``end`` in the view box that covers ``values``."""

    def __init__(self, values: Iterable[float], start: float, end: float) -> None:
        logs = [math.log10(value) for value in values] or [0.0]
        self._low, self._high = math.floor(min(logs) + 1e-9), math.ceil(max(logs) - 1e-9)
        self._high = max(self._high, self._low + 1)
        self._start, self._end = start, end

    def at(self, value: float) -> float:
        """Return the place of a value, which is moved to the edge if it lies outside."""
        share = (math.log10(value) - self._low) / (self._high - self._low)
        return self._start + min(max(share, 0.0), 1.0) * (self._end - self._start)

    def ticks(self) -> list[tuple[float, str]]:
        """Return places and labels of about LABELS decades."""
        every = -(-(self._high - self._low) // LABELS)
        return [(self.at(10.0**k), number(10.0**k)) for k in range(self._low, self._high + 1, every)]


def number(value: float) -> str:
    """Return a number with at most two digits, as "0.05", "1500" or "2e-8"."""
    if 0.01 <= value < 1e4:
        return f"{float(f'{value:.2g}'):g}"
    mantissa, exponent = f"{value:.1e}".split("e")
    return f"{mantissa.removesuffix('.0')}e{int(exponent)}"


def draw(chart: Chart) -> bytes:
    """Return a chart as an SVG file."""
    every = [point for curve in chart.curves for point in curve.points]
    ups = [y for _, y in every if LEAST <= y <= MOST] + [y for y, _ in chart.levels]
    x = _Axis([x for x, _ in every] + [x for x, _ in chart.walls], LEFT, WIDE - RIGHT)
    y = _Axis(ups, HIGH - BOTTOM, TOP)
    marks = [*_grid(chart, x, y)]
    for level, name in chart.levels:
        marks += [_LINE.format(LEFT, y.at(level), WIDE - RIGHT, y.at(level), "level")]
        marks += [_TEXT.format(LEFT + 3, y.at(level) - 3, "quiet", name)]
    for wall, name in chart.walls:
        marks += [_LINE.format(x.at(wall), TOP, x.at(wall), HIGH - BOTTOM, "level")]
        marks += [_TEXT.format(x.at(wall), TOP - 4, "quiet middle", name)]
    ends: list[tuple[float, str, str]] = []
    for curve in chart.curves:
        places = [(x.at(a), y.at(max(b, LEAST))) for a, b in curve.points if b <= MOST]
        path = "L".join(f"{a:.1f} {b:.1f}" for a, b in places)
        marks += [_PATH.format(f"M{path}", curve.color)] if places else []
        single = len(curve.points) == 1
        marks += [_CIRCLE.format(a, b, 4 if single else 1.8, "dot", curve.color) for a, b in places]
        off = [a for a, b in curve.points if b > MOST]
        marks += [_TEXT.format(x.at(a), TOP + 4, f"middle name {curve.color}", "×") for a in off]
        right, end = max(places, default=(0.0, TOP))
        if single:
            marks.append(_TEXT.format(right + 7, end + 3, f"name {curve.color}", curve.name))
        elif curve.name:
            ends.append((end, curve.name, curve.color))
    ends.sort()
    marks += [_CIRCLE.format(x.at(a), y.at(max(b, LEAST)), 5, "ring", color) for a, b, color in chart.rings]
    for place, (_, name, color) in zip(_apart([end[0] for end in ends]), ends, strict=True):
        marks.append(_TEXT.format(WIDE - RIGHT + 5, place + 3, f"name {color}", name))
    return str(_SVG.format(WIDE, HIGH, chart.title, STYLE, Markup("").join(marks))).encode()


def _grid(chart: Chart, x: _Axis, y: _Axis) -> Iterable[Markup]:
    for place, label in x.ticks():
        yield _LINE.format(place, TOP, place, HIGH - BOTTOM, "grid")
        yield _TEXT.format(place, HIGH - BOTTOM + 12, "middle quiet", label)
    for place, label in y.ticks():
        yield _LINE.format(LEFT, place, WIDE - RIGHT, place, "grid")
        yield _TEXT.format(LEFT - 4, place + 3, "end quiet", label)
    yield _TEXT.format((LEFT + WIDE - RIGHT) / 2, HIGH - 6, "middle", chart.across)
    yield _TEXT.format(2, 10, "", chart.up)


def _apart(heights: Sequence[float]) -> list[float]:
    """Return rising ``heights`` moved so that they are GAP apart and above the axis' labels."""
    places: list[float] = []
    for height in heights:
        places.append(max(height, places[-1] + GAP if places else 0.0))
    for k in range(len(places) - 1, -1, -1):
        places[k] = min(places[k], places[k + 1] - GAP if k + 1 < len(places) else HIGH - BOTTOM)
    return places
