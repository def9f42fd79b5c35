"""Stand-ins for what only a notebook front end has, so that cells which show things run here too and show nothing."""

import types
from typing import Any


def stand_ins() -> dict[str, types.ModuleType]:
    """Modules IPython and IPython.display: every name is a function that takes anything and returns None."""
    ipython, display = _Silent("IPython"), _Silent("IPython.display")
    ipython.__dict__.update(display=display, version_info=(9, 0))  # matplotlib asks for the version
    return {"IPython": ipython, "IPython.display": display}


class _Silent(types.ModuleType):
    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return lambda *args, **kwargs: None
