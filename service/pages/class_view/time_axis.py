"""Ticks of a time axis that fit any range from minutes to years, in the time zone of the request."""

from datetime import datetime, timedelta

from service.http.templating import ZONE

MINUTE, HOUR, DAY = 60, 3600, 86400
STEPS = (
    *(n * MINUTE for n in (1, 2, 5, 10, 15, 30)),
    *(n * HOUR for n in (1, 2, 3, 6, 12)),
    *(n * DAY for n in (1, 2, 7, 14, 28, 56, 91, 182, 364)),
)
"""Lengths between two ticks, in seconds."""


def ticks(start: datetime, until: datetime, most: int = 3) -> list[tuple[datetime, str]]:
    """Return at most ``most`` + 1 times from ``start`` to ``until``, evenly spaced at whole minutes, hours or
    days, each with its label: the time of day, or the day if the step is a day or more.
    """
    seconds = (until - start).total_seconds()
    step = next((step for step in STEPS if seconds / step <= most), STEPS[-1])
    local = start.astimezone(ZONE.get())
    at = local.replace(hour=0, minute=0, second=0, microsecond=0)
    if step < DAY:
        passed = (local.replace(tzinfo=None) - at.replace(tzinfo=None)).total_seconds()
        at += timedelta(seconds=step * -(-passed // step))
    elif at < local:
        at += timedelta(days=1)
    found = list[tuple[datetime, str]]()
    while at <= until:
        found.append((at, _label(at, step, first=not found)))
        at += timedelta(seconds=step)
    return found


def _label(at: datetime, step: int, *, first: bool) -> str:
    if step >= DAY:
        return f"{at:%d %b}" if step < STEPS[-1] else f"{at:%b %Y}"
    is_new_day = first or (at.hour, at.minute) == (0, 0)
    return f"{at:%d %b %H:%M}" if is_new_day else f"{at:%H:%M}"
