"""The course notebook's kit: ✓/✗ lines, drawing, local checks, and submitting to the course server.

The course server distributes it as ``polhode-kit-SLUG``, with the local checks of one assignment; it is
imported as ``polhode``. The package named ``polhode`` on the public index is unrelated. It needs numpy and
scipy, and imports matplotlib only to draw.
"""

import importlib
from typing import Any

from polhode import draw
from polhode.animation import animate
from polhode.judging import validate

KIT = "1"
"""The kit's generation. It changes only when a notebook written for an older kit no longer works with the
current server.
"""

_HOME = {
    "check": "local",
    "connect": "course",
    "submit": "remote",
    "submissions": "past_submissions",
    "login": "identity",
    "logout": "identity",
    "Report": "report",
    "header": "style",
    "footer": "style",
    "use_style": "style",
}

__all__ = [
    "Report",
    "animate",
    "check",
    "connect",
    "draw",
    "footer",
    "header",
    "login",
    "logout",
    "submissions",
]
__all__ += ["submit", "use_style", "validate"]


def __getattr__(name: str) -> Any:
    """Import a name of ``_HOME`` when it is first used: only a notebook needs these modules."""
    if name not in _HOME:
        raise AttributeError(
            f"module 'polhode' has no attribute {name!r}: is this the course's kit,"
            " installed from its server?"
        )
    return getattr(importlib.import_module(f"polhode.{_HOME[name]}"), name)
