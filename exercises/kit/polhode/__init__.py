"""The students' kit: local checks, submitting to the course server, and its report.

The course server distributes it as ``polhode-kit``; ``connect`` brings an assignment. It needs numpy and
scipy, and imports matplotlib only to draw.
"""

import importlib
import sys
from typing import Any

KIT = "1"
"""The kit's generation. It changes only when a notebook written for an older kit no longer works with the
current server.
"""

_HOME = {
    "check": "client.local",
    "connect": "client.course",
    "submit": "client.remote",
    "submissions": "client.past_submissions",
    "login": "client.login",
    "logout": "client.login",
    "Report": "report.report",
}

__all__ = ["Report", "check", "connect", "login", "logout", "submissions", "submit"]


def __getattr__(name: str) -> Any:
    """Import a name of ``_HOME`` when it is first used: only a notebook needs these modules."""
    if name not in _HOME:
        raise AttributeError(
            f"module 'polhode' has no attribute {name!r}: is this the course's kit,"
            " installed from its server?"
        )
    return getattr(importlib.import_module(f"polhode.{_HOME[name]}"), name)


def _use_packages() -> None:
    """Let a notebook's kernel import the course's packages of the assignment that was connected last."""
    last = importlib.import_module("polhode.client.cache").last()
    importlib.import_module("polhode.client.course_packages").use(last)


if "IPython" in sys.modules:
    _use_packages()
