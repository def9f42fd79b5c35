"""What the code of a published notebook needs besides itself: distributions, the course's own modules, data
files.
"""

import ast
import importlib.metadata
import re
import sys
from collections.abc import Iterator, Sequence
from importlib.util import find_spec
from pathlib import Path

import polhode
from exercises.author_notebook import Cell
from exercises.validation import REPLACEABLE
from polhode.client.data_files import MODULES

DATA_FILE = re.compile(r"(?!\.)[\w\-. ]+\.(csv|txt|dat|tsv|npy|npz|json|h5|fits)")
AVAILABLE = {"polhode", "numpy", "scipy", "matplotlib", "mpl_toolkits"}


def dependencies(
    cells: Sequence[Cell], folder: Path, course: Path | None
) -> tuple[list[str], dict[str, bytes], list[str]]:
    """Return what the code cells import and read: the packages to name in the declaration, the files that
    belong beside it by name, and warnings about what is missing. Data files are those in ``folder`` that the
    code names.

    ``course`` is a folder with modules that the notebooks of the course import as ``polhode.NAME``; those
    that the kit lacks, or that replace a module of the kit, become files of the assignment, with the modules
    that they import.
    """
    nodes, own = [node for cell in cells for node in cell.nodes], set[str]()
    texts = {node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str)}
    named = sorted(text for text in texts if DATA_FILE.fullmatch(text))
    files = {name: (folder / name).read_bytes() for name in named if (folder / name).is_file()}
    warnings = [
        f"{name} is not beside the notebook: the cells that read it fail"
        for name in named
        if name not in files
    ]
    warnings += _aliases(nodes)
    while course and (added := _own(_imported(nodes), course) - own):
        for name in sorted(added):
            files[f"{MODULES}/{name}.py"] = (course / f"{name}.py").read_bytes()
            nodes += ast.walk(ast.parse(files[f"{MODULES}/{name}.py"]))
        own |= added
    imported = _imported(nodes)
    absent = sorted(name for name in imported - {f"polhode.{name}" for name in own} if _is_missing(name))
    remedy = (
        "the cells that import it fail"
        if course
        else "name the folder of the course's modules with --modules"
    )
    warnings += [f"the kit has no {name}: {remedy}" for name in absent]
    known, packages = importlib.metadata.packages_distributions(), set[str]()
    for name in sorted(
        {module.split(".")[0] for module in imported} - AVAILABLE - set(sys.stdlib_module_names)
    ):
        if name in known:
            packages.add(known[name][0])
        else:
            warnings.append(f"{name} is not installed on this machine: install it, and name it in packages")
    return sorted(packages), files, warnings


def _imported(nodes: Sequence[ast.AST]) -> set[str]:
    """Return the modules, and the names of ``polhode``, that the code imports. Relative imports are those of
    a module of ``polhode``.
    """
    found = set[str]()
    for node in nodes:
        if isinstance(node, ast.Import):
            found |= {name.name for name in node.names}
        elif isinstance(node, ast.ImportFrom):
            module = ".".join(["polhode"] * node.level + ([node.module] if node.module else []))
            found |= {f"polhode.{name.name}" for name in node.names} if module == "polhode" else {module}
    return found


def _own(modules: set[str], course: Path) -> set[str]:
    """Return the names of the modules in ``course`` that stand for these ``modules``."""
    names = {module.split(".")[1] for module in modules if module.startswith("polhode.")}
    return {
        name
        for name in names
        if (name in REPLACEABLE or _is_missing(f"polhode.{name}")) and (course / f"{name}.py").is_file()
    }


def _is_missing(module: str) -> bool:
    first, _, name = module.partition(".")
    return first == "polhode" and bool(name) and not hasattr(polhode, name) and find_spec(module) is None


def _aliases(nodes: Sequence[ast.AST]) -> Iterator[str]:
    """Yield a warning for each other name of ``validate`` or of its functions, whose calls are not found."""
    for node in (node for node in nodes if isinstance(node, ast.ImportFrom)):
        for name in node.names:
            if (node.module, name.name) == ("polhode", "validate") and name.asname not in (None, "validate"):
                yield f"the notebook calls validate {name.asname}: calls under that name are not taken over"
            elif node.module == "polhode.judging.validate":
                yield (
                    f"the notebook imports validate.{name.name} by its own name: calls under it are not taken"
                    " over"
                )
