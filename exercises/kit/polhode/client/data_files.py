"""The data files of an assignment, and its own modules among them,
which its notebook imports from ``polhode``.
"""

import importlib
import sys
from pathlib import Path

import polhode

MODULES = "polhode"  # the folder of an assignment's data files with its own modules


def use_modules(folder: Path) -> None:
    """Let ``polhode`` have the modules in ``folder``, if it exists. They replace modules of the kit with the
    same names.
    """
    if not folder.is_dir() or str(folder) in polhode.__path__:
        return
    polhode.__path__.insert(0, str(folder))
    for name in [f"polhode.{path.stem}" for path in folder.glob("*.py")]:
        if sys.modules.pop(name, None):
            importlib.import_module(name)


def copy_data(home: Path) -> None:
    """Copy the data files in ``home`` to the current folder, except those that are there already.

    Print the name of each file that differs from the one there or cannot be written.
    """
    for source in sorted(path for path in home.rglob("*") if path.is_file()):
        name = source.relative_to(home)
        if name.parts[0] == MODULES:
            continue
        try:
            if not name.exists():
                name.parent.mkdir(parents=True, exist_ok=True)
                name.write_bytes(source.read_bytes())
            elif name.read_bytes() != source.read_bytes():
                print(
                    f"{name} in {Path.cwd()} differs from the course's file: rename yours and run this cell"
                    " again."
                )
        except OSError as error:
            print(f"{name} was not written to {Path.cwd()} ({error.strerror}): copy it there from {source}.")
