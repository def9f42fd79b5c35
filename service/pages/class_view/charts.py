"""Charts of the class overview as inline SVG: the distribution of points, and the progress over time."""

import math
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime, timedelta
from statistics import median

from markupsafe import Markup

from service.http.templating import ZONE
from service.pages.class_view.time_axis import ticks
from service.store.course.gradebook import StudentRow

WIDE, HIGH = 360, 200  # view box of a chart
LEFT, RIGHT, TOP, BOTTOM = 30, 8, 30, 34  # its margins; the numbers of the axes and their titles stand there
MOST_BINS = 12
SHORTEST = timedelta(minutes=2)  # that an axis of time shows
NAMES = 74  # width of the names right of the curves
_TEXT = Markup('<text x="{:.1f}" y="{:.1f}" class="{}">{}</text>')
_LINE = Markup('<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}" class="{}"></line>')
_PATH = Markup('<path d="{}" class="{}"></path>')


def distribution(students: Iterable[StudentRow], most: int) -> Markup | None:
    """Return a histogram of the counted points after the late penalty, ``most`` of which can be had without a
    bonus.

    A bin holds whole points: several if there are many, and the edges are marked then. None without points.
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
            bar = Markup('<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" class="bar"></rect>')
            marks.append(bar.format(x + 1, HIGH - BOTTOM - height, across * width - 2, height))
            marks.append(_TEXT.format(x + across * width / 2, HIGH - BOTTOM - height - 4, "middle", count))
        marks.append(
            _TEXT.format(
                x + (across / 2 if width == 1 else 0.0), HIGH - BOTTOM + 13, "middle quiet", number * width
            )
        )
    if width > 1:
        marks.append(_TEXT.format(WIDE - RIGHT, HIGH - BOTTOM + 13, "middle quiet", len(counts) * width))
    alt = f"Students by points: median {median(points):g} of {most}, from {min(points):g} to {max(points):g}."
    return _svg(alt, marks)


def progress(students: Sequence[StudentRow], most: int, due_at: datetime | None) -> Markup | None:
    """Return how many students had submitted, and had full marks, ``most`` points, at each time. None without
    a submission.

    The x axis is linear in time, the curves are steps.
    """
    first = sorted(s.sent_at[0] for s in students if s.sent_at)
    if not first:
        return None
    full = sorted(at for s in students if (at := _full_marks_at(s, most)) is not None)
    until = max(
        [s.sent_at[-1] for s in students if s.sent_at] + ([min(due_at, datetime.now(UTC))] if due_at else [])
    )
    start = first[0]
    until = max(until, start + SHORTEST)
    across = (WIDE - LEFT - RIGHT - NAMES) / (until - start).total_seconds()

    def x(at: datetime) -> float:
        return LEFT + across * (at - start).total_seconds()

    marks = [_axes("", "students")]
    for at, label in ticks(start, until):
        marks.append(_LINE.format(x(at), HIGH - BOTTOM, x(at), HIGH - BOTTOM + 3, "axis"))
        marks.append(_TEXT.format(x(at), HIGH - BOTTOM + 13, "middle quiet", label))
    marks.append(_TEXT.format(WIDE - RIGHT, HIGH - 4, "end quiet", f"time ({ZONE.get()})"))
    if due_at and start <= due_at <= until:
        marks.append(_LINE.format(x(due_at), TOP, x(due_at), HIGH - BOTTOM, "due"))
        marks.append(_TEXT.format(x(due_at), TOP - 4, "middle quiet", "deadline"))
    elif due_at and due_at > until:
        told = f"deadline {due_at.astimezone(ZONE.get()):%d %b %H:%M} →"
        marks.append(_TEXT.format(x(until), TOP - 4, "end quiet", told))
    ends = []
    for name, reached, kind in (("submitted", first, "line"), ("full marks", full, "line pass")):
        y, path = float(HIGH - BOTTOM), f"M{LEFT} {HIGH - BOTTOM}"
        for count, at in enumerate(reached, start=1):
            y = HIGH - BOTTOM - _height(count, len(students))
            path += f"H{x(at):.1f}V{y:.1f}"
        marks.append(_PATH.format(f"{path}H{x(until):.1f}", kind))
        ends.append((y, f"{len(reached)} {name}", kind))
    (upper, *upper_text), (lower, *lower_text) = ends
    lower = max(lower, upper + 12)
    for y, (text, kind) in ((upper, upper_text), (min(lower, HIGH - BOTTOM + 2.0), lower_text)):
        marks.append(_TEXT.format(x(until) + 4, y + 4, kind.replace("line", "name"), text))
    marks += [
        _TEXT.format(LEFT - 4, HIGH - BOTTOM - _height(n, len(students)) + 4, "end quiet", n)
        for n in {0, len(students)}
    ]
    who = f"{len(first)} of {len(students)} students submitted"
    return _svg(f"{who} from {start:%Y-%m-%d} to {until:%Y-%m-%d}; {len(full)} have full marks.", marks)


def _full_marks_at(student: StudentRow, most: int) -> datetime | None:
    sent = zip(student.sent_at, student.earned, strict=True)
    return next((at for at, points in sent if points is not None and points >= most), None)


def _height(count: int, most: int) -> float:
    return (HIGH - TOP - BOTTOM) * count / max(most, 1)


def _axes(across: str, up: str) -> Markup:
    base = _LINE.format(LEFT, HIGH - BOTTOM, WIDE - RIGHT, HIGH - BOTTOM, "axis")
    names = _TEXT.format(WIDE - RIGHT, HIGH - 4, "end quiet", across) if across else Markup("")
    return base + names + _TEXT.format(2, 10, "quiet", up)


def _svg(alt: str, marks: Iterable[Markup]) -> Markup:
    shown = Markup("").join(marks)
    return Markup('<svg class="chart" viewBox="0 0 {} {}" role="img" aria-label="{}">{}</svg>').format(
        WIDE, HIGH, alt, shown
    )
