"""What the code of a published notebook needs besides itself: distributions and data files."""

import ast
import importlib.metadata
import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from exercises.authoring.assignments import course_packages
from exercises.authoring.questions.author_notebook import Cell

DATA_FILE = re.compile(r"(?!\.)[\w\-. ]+\.(csv|txt|dat|tsv|npy|npz|json|h5|fits)")
AVAILABLE = {"polhode", "numpy", "scipy", "matplotlib", "mpl_toolkits"}


def dependencies(
    cells: Sequence[Cell], folder: Path, course: Path
) -> tuple[list[str], dict[str, bytes], list[str]]:
    """Return what the code cells import and read: the packages to name in the declaration, the data files in
    ``folder`` that the code names, and warnings about what is missing. ``course`` is the folder for the
    course's own packages, which may not exist.
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
    known, packages = importlib.metadata.packages_distributions(), set[str]()
    given = AVAILABLE | course_packages.names(course) | set(sys.stdlib_module_names)
    for name in sorted(_imported(nodes) - given):
        if name in known:
            packages.add(known[name][0])
        else:
            warnings.append(
                f"{name} is not installed on this machine: install it, and name it in packages; or name the"
                " folder of the course's package with --package"
            )
    return sorted(packages), files, warnings


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
