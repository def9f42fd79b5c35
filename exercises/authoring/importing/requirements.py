"""What the code of a published notebook needs besides itself: distributions and data files."""

import ast
import contextlib
import importlib.metadata
import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from exercises.authoring.assignments import course_packages
from exercises.authoring.assignments.packages import SANDBOX, with_requirements
from exercises.authoring.questions.author_notebook import Cell

DATA_FILE = re.compile(r"(?!\.)[\w\-. ]+\.(csv|txt|dat|tsv|npy|npz|json|h5|fits)")
NAMED = re.compile(r"\s*([A-Za-z0-9][\w.-]*)")
AVAILABLE = {"polhode", "numpy", "scipy", "matplotlib", "mpl_toolkits"}


class Dependencies(NamedTuple):
    """The ``packages`` to name in a declaration, the data ``files`` that the code names, warnings, and the
    modules that are ``lacking``: not installed on this machine.
    """

    packages: list[str]
    files: dict[str, bytes]
    warnings: list[str]
    lacking: list[str]


def dependencies(cells: Sequence[Cell], folder: Path, course: Path) -> Dependencies:
    """Return what the code cells, and the course's packages that they import, import and read. Data files are
    in ``folder``; ``course`` is the folder for the course's own packages, which may not exist.
    """
    nodes = [node for cell in cells for node in cell.nodes]
    texts = {node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str)}
    named = sorted(text for text in texts if DATA_FILE.fullmatch(text))
    files = {name: (folder / name).read_bytes() for name in named if (folder / name).is_file()}
    warnings = [
        f"{name} is not beside the notebook: the cells that read it fail"
        for name in named
        if name not in files
    ]
    warnings += _aliases(nodes)
    known = importlib.metadata.packages_distributions()
    given = AVAILABLE | course_packages.names(course) | set(sys.stdlib_module_names)
    imported = _imported(nodes)
    imported |= _imported(
        [node for path in course_packages.sources(imported, course) for node in _nodes(path)]
    )
    needed = sorted(imported - given)
    packages = {known[name][0] for name in needed if name in known} - with_requirements(SANDBOX).keys()
    return Dependencies(sorted(packages), files, warnings, [name for name in needed if name not in known])


def requirements(path: Path) -> dict[str, str]:
    """Return the lines of a requirements.txt that name a distribution, by its name as a module is written."""
    lines = path.read_text(encoding="utf-8").splitlines() if path.is_file() else []
    found = {
        match[1].lower().replace("-", "_"): line.strip() for line in lines if (match := NAMED.match(line))
    }
    return found


def _nodes(path: Path) -> Iterator[ast.AST]:
    with contextlib.suppress(SyntaxError, ValueError, OSError):  # named elsewhere
        yield from ast.walk(ast.parse(path.read_bytes()))


def _imported(nodes: Sequence[ast.AST]) -> set[str]:
    """Return the packages that the code imports."""
    found = set[str]()
    for node in nodes:
        if isinstance(node, ast.Import):
            found |= {name.name.partition(".")[0] for name in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            found.add(node.module.partition(".")[0])
    return found


def _aliases(nodes: Sequence[ast.AST]) -> Iterator[str]:
    """Yield a warning for each other name of ``validate`` or of its functions, whose calls are not found."""
    for node in (node for node in nodes if isinstance(node, ast.ImportFrom)):
        for name in node.names:
            if name.name == "validate" and name.asname not in (
                None,
                "validate",
            ):
                yield f"the notebook calls validate {name.asname}: calls under that name are not taken over"
            elif (node.module or "").endswith(".validate"):
                yield (
                    f"the notebook imports validate.{name.name} by its own name: calls under it are not taken"
                    " over"
                )
