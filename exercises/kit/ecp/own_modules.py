"""The assignment's own modules, which its notebook imports from ``ecp``. Apart from ``ecp.course``, which a guest does not need."""

import importlib
import sys
from pathlib import Path

import ecp

MODULES = "ecp"  # the folder of an assignment's data files with its own modules


def use_modules(folder: Path) -> None:
    """Let ``ecp`` have the modules in ``folder``, if it exists. They replace modules of the kit with the same names."""
    if not folder.is_dir() or str(folder) in ecp.__path__:
        return
    ecp.__path__.insert(0, str(folder))
    for name in [f"ecp.{path.stem}" for path in folder.glob("*.py")]:
        if sys.modules.pop(name, None):
            importlib.import_module(name)
