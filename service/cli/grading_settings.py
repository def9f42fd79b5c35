"""The settings of ``polhode grade``. Without settings in the environment they need no pydantic, which takes
0.1 s to import.
"""

import os
from typing import TYPE_CHECKING, Literal, NamedTuple

if TYPE_CHECKING:
    from service.settings import Settings

OF_THE_CATALOGUE = ("POLHODE_ASSIGNMENTS", "POLHODE_COURSE")


class Defaults(NamedTuple):
    """The defaults of those ``Settings`` that apply to grading on this machine."""

    min_isolation: Literal["namespaces", "process"] = "process"
    allow_root_guest: bool = False
    submission_kib: int = 256
    upload_mib: int = 20
    grading_cpu: float = 60.0
    grading_wall: float = 120.0


def read_settings() -> "Settings | Defaults":
    """Return the settings. Raises pydantic's ValidationError if one is invalid."""
    if not any(name.upper().startswith("POLHODE_") and name not in OF_THE_CATALOGUE for name in os.environ):
        return Defaults()
    from service.settings import Settings

    return Settings()
