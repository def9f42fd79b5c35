"""The distributions that the course's own packages import, which the sandbox and students' notebooks have."""

import ast
import functools
import importlib.metadata
import sys
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path

from exercises.authoring.assignments.packages import SANDBOX, missing, with_requirements

ALWAYS = {"polhode", "numpy", "scipy", "matplotlib", "mpl_toolkits", "IPython"}


@functools.cache
def distributions(folders: Sequence[Path]) -> tuple[str, ...]:
    """Return the installed distributions that the Python files in ``folders`` import, without those that
    every sandbox has.
    """
    own = {path.stem for folder in folders for path in folder.iterdir()}
    files = [file for folder in folders for file in sorted(folder.rglob("*.py"))]
    named = {name for file in files for name in _imported(file)} - own - ALWAYS - sys.stdlib_module_names
    elsewhere = set(missing(named))
    known = importlib.metadata.packages_distributions() if elsewhere else {}
    found = {known[name][0] for name in elsewhere if name in known} | (named - elsewhere)
    return tuple(sorted(found - with_requirements(SANDBOX).keys())) if found else ()


def _imported(file: Path) -> Iterator[str]:
    with suppress(SyntaxError, ValueError, OSError):  # named elsewhere
        for node in ast.walk(ast.parse(file.read_bytes())):
            if isinstance(node, ast.Import):
                yield from (alias.name.partition(".")[0] for alias in node.names)
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                yield node.module.partition(".")[0]
