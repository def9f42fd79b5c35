"""The distributions that the course's own packages import, which the sandbox and students' notebooks have."""

import ast
import functools
import importlib.metadata
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path

from exercises.authoring.assignments.packages import SANDBOX, missing, with_requirements

ALWAYS = {"polhode", "numpy", "scipy", "matplotlib", "mpl_toolkits", "IPython"}


def distributions(folders: Sequence[Path]) -> tuple[str, ...]:
    """Return the installed distributions that the Python files in ``folders`` import, without those that
    every sandbox has.
    """
    return tuple(sorted(set(_needed(tuple(folders)).values())))


def libraries(folders: Sequence[Path]) -> tuple[str, ...]:
    """Return the modules of these distributions that are imported as soon as a file of ``folders`` is."""
    needed = _needed(tuple(folders))
    return tuple(sorted({name for _, top in _imports(folders) for name in top if name in needed}))


@functools.cache
def _needed(folders: Sequence[Path]) -> dict[str, str]:
    """Return the distribution of each module."""
    own = {path.stem for folder in folders for path in folder.iterdir()}
    imported = set[str]().union(*(anywhere for anywhere, _ in _imports(folders)))
    named = imported - own - ALWAYS - sys.stdlib_module_names
    elsewhere = set(missing(named))
    known = importlib.metadata.packages_distributions() if elsewhere else {}
    found = {name: name for name in named - elsewhere}
    found |= {name: known[name][0] for name in elsewhere if name in known}
    given = with_requirements(SANDBOX) if found else {}
    return {name: distribution for name, distribution in found.items() if distribution not in given}


def _imports(folders: Sequence[Path]) -> Iterator[tuple[set[str], set[str]]]:
    """Yield the modules that each file imports anywhere, and those that it imports at once."""
    for file in (file for folder in folders for file in sorted(folder.rglob("*.py"))):
        with suppress(SyntaxError, ValueError, OSError):  # named elsewhere
            tree = ast.parse(file.read_bytes())
            yield set(_imported(ast.walk(tree))), set(_imported(tree.body))


def _imported(nodes: Iterable[ast.AST]) -> Iterator[str]:
    for node in nodes:
        if isinstance(node, ast.Import):
            yield from (alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield node.module.partition(".")[0]
