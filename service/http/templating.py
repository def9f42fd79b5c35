"""Jinja templates of the pages, with automatic escaping.

Every template gets the logged-in person ``me`` and their ``role``.
"""

import re
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

from fastapi import Request
from fastapi.templating import Jinja2Templates
from jinja2 import Environment, FileSystemLoader, select_autoescape
from markupsafe import Markup

from service.sandbox.untrusted_text import BIDI_CONTROLS

_BIDI, _REPLACED = re.compile(f"[{BIDI_CONTROLS}]"), dict.fromkeys(map(ord, BIDI_CONTROLS), "\ufffd")


def neutralize_bidi(value: object) -> str:
    """Return the value as text, with U+FFFD in place of bidirectional control characters.

    Markup stays Markup.
    """
    shown = value if isinstance(value, str) else str(value)
    return shown.translate(_REPLACED) if _BIDI.search(shown) else shown


ENVIRONMENT = Environment(
    loader=FileSystemLoader(Path(__file__).parents[1] / "pages" / "templates"),
    autoescape=select_autoescape(),
    trim_blocks=True,
    lstrip_blocks=True,
    finalize=neutralize_bidi,
)


def format_time(at: datetime | None, seconds: bool = False) -> Markup | str:
    """Return the time in UTC as a ``<time>`` element, or a dash for None."""
    if at is None:
        return "–"
    at = at.astimezone(UTC)
    shown = at.strftime("%Y-%m-%d %H:%M:%S" if seconds else "%Y-%m-%d %H:%M")
    return Markup('<time datetime="{}">{}</time>').format(at.isoformat(), shown)


def format_duration(took: timedelta) -> str:
    """Return the duration as text, in ms, s, min or h."""
    seconds = took.total_seconds()
    if seconds < 1:
        return f"{1e3 * seconds:.0f} ms"
    return f"{seconds:.1f} s" if seconds < 90 else f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def _common_context(request: Request) -> dict[str, Any]:
    person = getattr(request.state, "person", None)
    return {"me": person, "role": person and person.role}


ENVIRONMENT.filters |= {"moment": format_time, "duration": format_duration}
templates = Jinja2Templates(env=ENVIRONMENT, context_processors=[_common_context])
