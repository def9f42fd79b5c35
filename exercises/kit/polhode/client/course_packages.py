"""The course's own packages that came with an assignment, as a notebook's kernel imports them: after all that
is installed.
"""

import importlib.util
import re
import sys
from collections.abc import Iterator, Sequence
from contextlib import suppress
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from types import FrameType, ModuleType

from polhode.client import cache

WORD = re.compile(r"^def (check|close)\(", re.MULTILINE)  # which validation cells of all courses call
NOT_BROUGHT = (
    "No module named {name!r}: if it is the course's own package, first run the cell that calls"
    " polhode.connect(…), which brings it"
)


class Packages(MetaPathFinder):
    """Finder of the packages in ``folder``. It has to be behind all other finders: a package in editable mode
    has one of its own, behind the folders of ``sys.path``.

    Where there is no such folder because nothing has been brought, a cell that imports an unknown package
    learns what brings the course's.
    """

    def __init__(self, folder: Path | None) -> None:
        self.folder = folder

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return the spec of a package in the folder; raise ModuleNotFoundError with the sentence."""
        if path is not None:
            return None
        if self.folder is not None:
            return PathFinder.find_spec(name, [str(self.folder)], target)
        if _is_cell(sys._getframe(1)):
            raise ModuleNotFoundError(NOT_BROUGHT.format(name=name), name=name)
        return None


def use(assignment: str | None) -> None:
    """Let the packages that came with an assignment be imported, and no more those of another one."""
    folder = cache.home(assignment) / "course" if assignment is not None and cache.made(assignment) else None
    packages = Packages(folder)
    sys.meta_path[:] = [one for one in sys.meta_path if type(one).__qualname__ != Packages.__qualname__]
    sys.meta_path.append(packages)


def lacking(assignment: str) -> Iterator[str]:
    """Yield a sentence for each installed package that hides one of an assignment and lacks modules or words
    of it.
    """
    folder = cache.home(assignment) / "course"
    for own in sorted(path for path in folder.glob("*") if (path / "__init__.py").is_file()):
        with suppress(ImportError, ValueError):
            spec = importlib.util.find_spec(own.name)
            home = Path((spec and (spec.origin or next(iter(spec.submodule_search_locations or ())))) or "")
            home = home.parent if home.suffix else home
            if spec is None or home == own:
                continue
            parts = sorted(path for path in own.glob("[!_]*.py"))
            absent = [f"{own.name}.{part.stem}" for part in parts if not _has(home, part)]
            if absent:
                yield (
                    f"The package {own.name} that is installed in {home} is not the course's: it lacks"
                    f" {', '.join(absent)}. Run %pip uninstall {own.name}, or rename the folder, and restart"
                    " the kernel."
                )


def _has(home: Path, part: Path) -> bool:
    """Return whether a package has a module, and if that has validation words, these."""
    if not (home / part.name).is_file():
        return (home / part.stem).is_dir() or any(home.glob(f"{part.stem}.*.*"))
    defined = [set(WORD.findall(path.read_text(encoding="utf-8"))) for path in (part, home / part.name)]
    return defined[0] <= defined[1]


def _is_cell(frame: FrameType | None) -> bool:
    """Return whether the import statement behind ``frame``, of a finder's caller, is one of the notebook."""
    while frame is not None and frame.f_code.co_filename.startswith("<frozen importlib._bootstrap"):
        frame = frame.f_back
    return frame is not None and frame.f_globals.get("__name__") == "__main__"
