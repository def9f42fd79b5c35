"""What the code of a published notebook needs besides itself: distributions, the course's own modules, data files."""

import ast
import importlib.metadata
import re
import sys
from collections.abc import Iterator, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import ecp
from ecp.course import MODULES
from ecp.notebook.cells import statements_of
from exercises.author_notebook import Cell
from exercises.validation import REPLACEABLE

DATA_FILE = re.compile(r"(?!\.)[\w\-. ]+\.(csv|txt|dat|tsv|npy|npz|json|h5|fits)")
AVAILABLE = {"ecp", "numpy", "scipy", "matplotlib", "mpl_toolkits"}


class Dependencies(NamedTuple):
    """The ``packages`` to name in the declaration, the ``files`` that belong beside it by name, and the ``warnings`` about what
    is missing.
    """

    packages: list[str]
    files: dict[str, bytes]
    warnings: list[str]


def dependencies(cells: Sequence[Cell], folder: Path, course: Path | None) -> Dependencies:
    """Return what the code cells import and read. Data files are those in ``folder`` that the code names.

    ``course`` is a folder with modules that the notebooks of the course import as ``ecp.NAME``; those that the kit lacks, or that
    replace a module of the kit, become files of the assignment, with the modules that they import.
    """
    trees = [s.node for cell in cells if cell.kind == "code" for s in statements_of(cell.source)]
    files, warnings = _data(trees, folder)
    warnings += _aliases(_nodes(trees))
    own = dict[str, ast.AST]()
    while added := _own(_imported([*trees, *own.values()]), course) - set(own) if course else set():
        for name in sorted(added):
            assert course is not None
            files[f"{MODULES}/{name}.py"] = (course / f"{name}.py").read_bytes()
            own[name] = ast.parse(files[f"{MODULES}/{name}.py"])
    imported = _imported([*trees, *own.values()])
    absent = sorted(name for name in imported - {f"ecp.{name}" for name in own} if _is_missing(name))
    remedy = "the cells that import it fail" if course else "name the folder of the course's modules with --modules"
    warnings += [f"the kit has no {name}: {remedy}" for name in absent]
    known, packages = importlib.metadata.packages_distributions(), set[str]()
    for name in sorted({module.split(".")[0] for module in imported} - AVAILABLE - set(sys.stdlib_module_names)):
        if name in known:
            packages.add(known[name][0])
        else:
            warnings.append(f"{name} is not installed on this machine: install it, and name it in packages")
    return Dependencies(sorted(packages), files, warnings)


def _nodes(trees: Sequence[ast.AST]) -> list[ast.AST]:
    return [node for tree in trees for node in ast.walk(tree)]


def _imported(trees: Sequence[ast.AST]) -> set[str]:
    """Return the modules, and the names of ``ecp``, that the code imports. Relative imports are those of a module of ``ecp``."""
    found = set[str]()
    for node in _nodes(trees):
        if isinstance(node, ast.Import):
            found |= {name.name for name in node.names}
        elif isinstance(node, ast.ImportFrom):
            module = ".".join(["ecp"] * node.level + ([node.module] if node.module else []))
            found |= {f"ecp.{name.name}" for name in node.names} if module == "ecp" else {module}
    return found


def _own(modules: set[str], course: Path) -> set[str]:
    """Return the names of the modules in ``course`` that stand for these ``modules``."""
    names = {module.split(".")[1] for module in modules if module.startswith("ecp.")}
    return {name for name in names if (name in REPLACEABLE or _is_missing(f"ecp.{name}")) and (course / f"{name}.py").is_file()}


def _is_missing(module: str) -> bool:
    first, _, name = module.partition(".")
    return first == "ecp" and bool(name) and not hasattr(ecp, name) and find_spec(module) is None


def _data(trees: Sequence[ast.AST], folder: Path) -> tuple[dict[str, bytes], list[str]]:
    named = {node.value for node in _nodes(trees) if isinstance(node, ast.Constant) and isinstance(node.value, str)}
    files = sorted(name for name in named if DATA_FILE.fullmatch(name))
    found = {name: (folder / name).read_bytes() for name in files if (folder / name).is_file()}
    return found, [f"{name} is not beside the notebook: the cells that read it fail" for name in files if name not in found]


def _aliases(nodes: Sequence[ast.AST]) -> Iterator[str]:
    """Yield a warning for each other name of ``validate`` or of its functions, whose calls are not found."""
    for node in nodes:
        for name in node.names if isinstance(node, ast.ImportFrom) else ():
            module = node.module if isinstance(node, ast.ImportFrom) else None
            if (module, name.name) == ("ecp", "validate") and name.asname not in (None, "validate"):
                yield f"the notebook calls validate {name.asname}: calls under that name are not taken over"
            elif module == "ecp.validate":
                yield f"the notebook imports validate.{name.name} by its own name: calls under it are not taken over"
