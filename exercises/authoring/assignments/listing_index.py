"""The index of an assignment: what lists of a course show of it, so that a server of many assignments loads
one when it is read or graded.

Whatever loads an assignment writes it, beside the folder's compiled files and, like these, only where it may.
It counts while the assignment's files are those that it was written for.
"""

import hashlib
import json
from collections import Counter
from collections.abc import Callable, Collection
from contextlib import suppress
from pathlib import Path
from typing import Any

from exercises.authoring.assignments.assignment import Assignment
from exercises.authoring.importing.reported_lines import reported_lines

INDEX = Path("__pycache__", "index.json")
SHOWN = ("title", "version", "packages", "most_points", "points_note")
COUNTED = ("max_points", "line_counts")


class IndexedAssignment:
    """An assignment that is loaded when anything is read that its index does not have.

    ``more`` are the distributions that the course's own packages add to those of the assignment.
    """

    def __init__(
        self, folder: Path, index: dict[str, Any], more: Collection[str], load: Callable[[], Assignment]
    ) -> None:
        self.folder, self.slug = folder, folder.name.replace("_", "-")
        self._load, self._most = load, int(index["max_points"])
        self.packages = tuple(dict.fromkeys([*index["packages"], *more]))
        self.title, self.version = index["title"], index["version"]
        self.most_points, self.points_note = index["most_points"], index["points_note"]
        self.line_counts: dict[str, int] = index["line_counts"]

    def max_points(self, numbers: Collection[str] | None = None, *more: Any) -> int:
        """Return the points that a submission can earn, as ``Assignment.max_points`` does."""
        return self._most if numbers is None and not more else self._load().max_points(numbers, *more)

    def __getattr__(self, name: str) -> Any:
        """Return an attribute of the loaded assignment."""
        return getattr(self._load(), name)


def write_index(assignment: Assignment) -> None:
    """Write the index of an assignment, without what the course's own packages add to it."""
    index = {name: getattr(assignment, name) for name in SHOWN} | {
        "max_points": assignment.max_points(),
        "line_counts": line_counts(assignment),
        "files": _digest(assignment.folder),
    }
    path = assignment.folder / INDEX
    with suppress(OSError):
        path.parent.mkdir(exist_ok=True)
        path.write_text(json.dumps(index, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def line_counts(assignment: Assignment) -> dict[str, int]:
    """Return how many lines of its notebook an assignment takes over, by the name of their status."""
    if isinstance(assignment, IndexedAssignment):
        return assignment.line_counts
    return dict(Counter(line.declared.status.name for line in reported_lines(assignment.checks())))


def read_index(folder: Path) -> dict[str, Any] | None:
    """Return the index of the assignment in ``folder``, None if there is none or its files have changed."""
    try:
        index = json.loads((folder / INDEX).read_text(encoding="utf-8"))
        valid = index["files"] == _digest(folder) and {*SHOWN, *COUNTED} <= index.keys()
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None
    return index if valid else None


def _digest(folder: Path) -> str:
    """Return a digest of the files of an assignment: code, notebook and data, but no hidden files."""
    digest = hashlib.sha256()
    for path in sorted(one for one in folder.iterdir() if one.is_file() and not one.name.startswith(".")):
        digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()
