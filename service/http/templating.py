"""Jinja templates of the pages, with automatic escaping.

Every template gets the logged-in person ``me`` and their ``role``.
"""

import re
from contextvars import ContextVar
from datetime import UTC, datetime, timedelta, tzinfo
from pathlib import Path
from typing import Any
from zoneinfo import ZoneInfo

from fastapi import Request
from fastapi.templating import Jinja2Templates
from jinja2 import Environment, FileSystemLoader, select_autoescape
from markupsafe import Markup

from service.sandbox.untrusted_text import BIDI_CONTROLS

_BIDI, _REPLACED = re.compile(f"[{BIDI_CONTROLS}]"), dict.fromkeys(map(ord, BIDI_CONTROLS), "\ufffd")


def find_zone(name: str) -> tzinfo:
    """Return the time zone of that name, UTC if this machine does not know it."""
    try:
        return UTC if name == "UTC" else ZoneInfo(name)
    except (ValueError, OSError, LookupError):
        return UTC


HALF_YEAR_S = 182 * 86400.0
ZONE: ContextVar[tzinfo] = ContextVar("ZONE", default=UTC)
"""The time zone in which the pages of a request show times and read those of forms."""


def neutralize_bidi(value: object) -> str:
    """Return the value as text, with U+FFFD in place of bidirectional control characters.

    Markup stays Markup.
    """
    shown = value if isinstance(value, str) else str(value)
    # The controls are not printable, and isprintable() is much faster than the search.
    return shown if shown.isprintable() or not _BIDI.search(shown) else shown.translate(_REPLACED)


ENVIRONMENT = Environment(
    loader=FileSystemLoader(Path(__file__).parents[1] / "pages" / "templates"),
    autoescape=select_autoescape(),
    trim_blocks=True,
    lstrip_blocks=True,
    finalize=neutralize_bidi,
)


def format_time(at: datetime | None, seconds: bool = False) -> Markup | str:
    """Return the time in the time zone of the request as a ``<time>`` element, or a dash for None."""
    if at is None:
        return "–"
    shown = at.astimezone(ZONE.get()).strftime("%Y-%m-%d %H:%M:%S" if seconds else "%Y-%m-%d %H:%M")
    return Markup('<time datetime="{}">{}</time>').format(
        at.astimezone(UTC).isoformat(timespec="seconds"), shown
    )


def format_relative(at: datetime | None) -> Markup | str:
    """Return how far the time is from now, "in 2 days", or a date if that is more than two weeks, as a
    ``<time>`` element whose title is the time itself.
    """
    if at is None:
        return "–"
    local, seconds = at.astimezone(ZONE.get()), (at - datetime.now(UTC)).total_seconds()
    lengths = ((90, 1, ""), (5400, 60, "min"), (129600, 3600, "h"), (1209600, 86400, "day"))
    for most, length, unit in lengths:
        if abs(seconds) < most:
            count = round(abs(seconds) / length)
            span = f"{count} {unit}{'s' * (unit == 'day' and count != 1)}"
            shown = "now" if not unit else f"in {span}" if seconds > 0 else f"{span} ago"
            break
    else:
        shown = f"on {local.day} {local:%B}" + (f" {local.year}" if abs(seconds) > HALF_YEAR_S else "")
    exact = at.astimezone(UTC).isoformat(timespec="seconds")
    return Markup(  # noqa: S704 - dates, and the name of a known time zone
        f'<time datetime="{exact}" title="{local:%Y-%m-%d %H:%M} {ZONE.get()}">{shown}</time>'
    )


def format_input(at: datetime | None) -> str:
    """Return the time in the time zone of the request as the value of a datetime-local field, "" for None."""
    return at.astimezone(ZONE.get()).strftime("%Y-%m-%dT%H:%M") if at else ""


def format_duration(took: timedelta) -> str:
    """Return the duration as text, in ms, s, min or h."""
    seconds = took.total_seconds()
    if seconds < 1:
        return f"{1e3 * seconds:.0f} ms"
    return (
        f"{seconds:.1f} s"
        if seconds < 90
        else f"{seconds / 60:.0f} min"
        if seconds < 5400
        else f"{seconds / 3600:.1f} h"
    )


def format_span(seconds: float) -> str:
    """Return the length of a grace period in min, h or days, whichever is the longest that it is a whole
    number of, or min.
    """
    for length, name in ((86400, "day"), (3600, "h")):
        if seconds and seconds % length == 0:
            count = int(seconds // length)
            return f"{count} {name}{'s' if name == 'day' and count > 1 else ''}"
    return f"{seconds / 60:g} min"


def _common_context(request: Request) -> dict[str, Any]:
    person = getattr(request.state, "person", None)
    return {"me": person, "role": person and person.role}


ENVIRONMENT.filters |= {
    "moment": format_time,
    "relative": format_relative,
    "input": format_input,
    "duration": format_duration,
    "span": format_span,
}
ENVIRONMENT.globals["zone"] = lambda: str(ZONE.get())
templates = Jinja2Templates(env=ENVIRONMENT, context_processors=[_common_context])
