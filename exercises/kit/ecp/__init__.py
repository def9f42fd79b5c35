"""ecp: the kit of the course notebook: ✓/✗ lines, drawing, local checks, and submitting to the course's server.

It is distributed by the course server as ``polhode-kit`` and imported as ``ecp``. (The package called ``ecp`` on the public
index is somebody else's.) Needs numpy and scipy; matplotlib is imported only when something is drawn.
"""

import importlib
from typing import Any

from ecp import animate, draw, validate

KIT = "1"
"""The generation of the kit: it stays while a notebook of old works with a server of today."""

_HOME = {
    "check": "local",
    "connect": "course",
    "submit": "remote",
    "attempts": "past_submissions",
    "login": "identity",
    "logout": "identity",
    "Report": "report",
    "header": "style",
    "footer": "style",
    "use_style": "style",
}

__all__ = ["Report", "animate", "attempts", "check", "connect", "draw", "footer", "header", "login", "logout", "submit"]
__all__ += ["use_style", "validate"]


def __getattr__(name: str) -> Any:
    """What only a notebook needs is imported when it is first used."""
    if name not in _HOME:
        raise AttributeError(f"module 'ecp' has no attribute {name!r}: is this the course's kit, installed from its server?")
    return getattr(importlib.import_module(f"ecp.{_HOME[name]}"), name)
