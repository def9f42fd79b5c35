"""Charts of the class overview as inline SVG: the distribution of points, and the progress over time."""

import math
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from statistics import median

from markupsafe import Markup

from service.http.templating import ZONE
from service.store.course.gradebook import StudentRow
from service.store.database import Row

WIDE, HIGH = 360, 200  # view box of a chart
LEFT, RIGHT, TOP, BOTTOM = 30, 8, 30, 34  # its margins; the numbers of the axes and their titles stand there
MOST_BINS = 12
NAMES = 74  # width of the names right of the curves
_TEXT = Markup('<text x="{:.1f}" y="{:.1f}" class="{}">{}</text>')
_LINE = Markup('<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}" class="{}"></line>')
_PATH = Markup('<path d="{}" class="{}"></path>')


def distribution(students: Iterable[StudentRow], most: int) -> Markup | None:
    """Return a histogram of the counted points after the late penalty, ``most`` of which can be had without a bonus.

    A bin holds whole points: several if there are many, and its least stands at its left edge. None without points.
    """
    points = [float(s.final) for s in students if s.final is not None]
    if not points:
        return None
    highest = max(most, math.ceil(max(points)))
    width = max(1, math.ceil((highest + 1) / MOST_BINS))
    counts = [0] * (highest // width + 1)
    for value in points:
        counts[max(0, int(value // width))] += 1
    across = (WIDE - LEFT - RIGHT) / (len(counts) * width)
    tallest = max(counts)
    marks = [_axes("points", "students")]
    for number, count in enumerate(counts):
        x, height = LEFT + across * width * number, _height(count, tallest)
        if count:
            marks.append(Markup('<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" class="bar"></rect>').format(
                x + 1, HIGH - BOTTOM - height, across * width - 2, height))  # fmt: skip
            marks.append(_TEXT.format(x + across * width / 2, HIGH - BOTTOM - height - 4, "middle", count))
        marks.append(_TEXT.format(x + (across / 2 if width == 1 else 0.0), HIGH - BOTTOM + 13, "middle quiet", number * width))
    alt = f"Students by points: median {median(points):g} of {most}, from {min(points):g} to {max(points):g}."
    return _svg(alt, marks)


def progress(sent: Sequence[Row], students: int, most: int, due_at: datetime | None) -> Markup | None:
    """Return how many of ``students`` had submitted, and had all ``most`` points, at each time. None without a submission.

    ``sent`` are all submissions as ``progress.of_class`` returns them. The x axis is linear in time, the curves are steps.
    """
    if not sent:
        return None
    until = max([sent[-1].submitted_at, *([min(due_at, datetime.now(UTC))] if due_at else [])])
    start, seconds = sent[0].submitted_at, max((until - sent[0].submitted_at).total_seconds(), 3600.0)
    across = (WIDE - LEFT - RIGHT - NAMES) / seconds

    def x(at: datetime) -> float:
        return LEFT + across * (at - start).total_seconds()

    first: dict[str, datetime] = {}
    full: dict[str, datetime] = {}
    for row in sent:
        first.setdefault(row.name, row.submitted_at)
        if row.points is not None and row.points >= most:
            full.setdefault(row.name, row.submitted_at)
    marks = [_axes("", "students")]
    for place, at in (("start", start), ("middle", start + (until - start) / 2), ("end", until)):
        marks.append(_TEXT.format(x(at), HIGH - BOTTOM + 13, f"{place} quiet", at.astimezone(ZONE.get()).strftime("%d %b %H:%M")))
    marks.append(_TEXT.format(WIDE - RIGHT, HIGH - 4, "end quiet", f"time ({ZONE.get()})"))
    if due_at and start <= due_at <= until:
        marks += [
            _LINE.format(x(due_at), TOP, x(due_at), HIGH - BOTTOM, "due"),
            _TEXT.format(x(due_at), TOP - 4, "middle quiet", "deadline"),
        ]
    ends = []
    for name, reached, kind in (("submitted", first, "line"), ("all points", full, "line pass")):
        y, path = float(HIGH - BOTTOM), f"M{LEFT} {HIGH - BOTTOM}"
        for count, at in enumerate(sorted(reached.values()), start=1):
            y = HIGH - BOTTOM - _height(count, students)
            path += f"H{x(at):.1f}V{y:.1f}"
        marks.append(_PATH.format(f"{path}H{x(until):.1f}", kind))
        ends.append((y, f"{len(reached)} {name}", kind))
    (upper, *upper_text), (lower, *lower_text) = ends
    lower = max(lower, upper + 12)
    for y, (text, kind) in ((upper, upper_text), (min(lower, HIGH - BOTTOM + 2.0), lower_text)):
        marks.append(_TEXT.format(x(until) + 4, y + 4, kind.replace("line", "name"), text))
    marks += [_TEXT.format(LEFT - 4, HIGH - BOTTOM - _height(n, students) + 4, "end quiet", n) for n in {0, students}]
    alt = f"{len(first)} of {students} students submitted from {start:%Y-%m-%d} to {until:%Y-%m-%d}; {len(full)} have all points."
    return _svg(alt, marks)


def _height(count: int, most: int) -> float:
    return (HIGH - TOP - BOTTOM) * count / max(most, 1)


def _axes(across: str, up: str) -> Markup:
    base = _LINE.format(LEFT, HIGH - BOTTOM, WIDE - RIGHT, HIGH - BOTTOM, "axis")
    names = _TEXT.format(WIDE - RIGHT, HIGH - 4, "end quiet", across) if across else Markup("")
    return base + names + _TEXT.format(2, 10, "quiet", up)


def _svg(alt: str, marks: Iterable[Markup]) -> Markup:
    shown = Markup("").join(marks)
    return Markup('<svg class="chart" viewBox="0 0 {} {}" role="img" aria-label="{}">{}</svg>').format(WIDE, HIGH, alt, shown)
