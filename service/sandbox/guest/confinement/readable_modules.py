"""Finder of modules that this process may read.

At isolation level ``process`` a child can list the folder of all installed packages and read some of them.
Python would find the others too and fail with PermissionError, which no library expects of an optional
import.
"""

import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType


class ReadableFinder(PathFinder):
    """Finds what PathFinder does, without packages whose files this process may not read."""

    @classmethod
    def find_spec(
        cls, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return the spec of a module, or None if there is none that can be read."""
        spec = super().find_spec(fullname, path, target)
        is_part = path is not None  # of a package that was found
        return spec if spec is None or is_part or _is_readable(spec) else None


def install() -> None:
    """Let this process and its children import only what they may read."""
    sys.meta_path[sys.meta_path.index(PathFinder)] = ReadableFinder


def _is_readable(spec: ModuleSpec) -> bool:
    if not spec.has_location or spec.origin is None:
        return True
    try:
        open(spec.origin, "rb").close()
    except PermissionError:
        return False
    except OSError:
        pass  # the import says what is wrong with the file
    return True
