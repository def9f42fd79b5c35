"""The pages' templates; everything they show is escaped. Every page knows who looks (``me``) and as what (``role``)."""

import re
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

from fastapi import Request
from fastapi.templating import Jinja2Templates
from jinja2 import Environment, FileSystemLoader, select_autoescape
from markupsafe import Markup

TURNING = "\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"  # they reorder the text around them
_TURNING, _STILL = re.compile(f"[{TURNING}]"), dict.fromkeys(map(ord, TURNING), "\ufffd")


def neutralize_bidi(value: object) -> str:
    """What a page shows of a value: with U+FFFD for whatever turns the direction of the text beside it."""
    shown = value if isinstance(value, str) else str(value)
    return shown.translate(_STILL) if _TURNING.search(shown) else shown  # of Markup this is Markup


ENVIRONMENT = Environment(
    loader=FileSystemLoader(Path(__file__).parents[1] / "pages" / "templates"),
    autoescape=select_autoescape(),
    trim_blocks=True,
    lstrip_blocks=True,
    finalize=neutralize_bidi,
)


def format_time(at: datetime | None, seconds: bool = False) -> Markup | str:
    """A moment as a ``<time>`` element, in UTC; a dash for none."""
    if at is None:
        return "–"
    at = at.astimezone(UTC)
    shown = at.strftime("%Y-%m-%d %H:%M:%S" if seconds else "%Y-%m-%d %H:%M")
    return Markup('<time datetime="{}">{}</time>').format(at.isoformat(), shown)


def format_duration(took: timedelta) -> str:
    """How long something took, in the unit that suits it."""
    seconds = took.total_seconds()
    if seconds < 1:
        return f"{1e3 * seconds:.0f} ms"
    return f"{seconds:.1f} s" if seconds < 90 else f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def _around(request: Request) -> dict[str, Any]:
    return {"me": getattr(request.state, "person", None), "role": getattr(request.state, "role", None)}


ENVIRONMENT.filters |= {"moment": format_time, "duration": format_duration}
templates = Jinja2Templates(env=ENVIRONMENT, context_processors=[_around])
