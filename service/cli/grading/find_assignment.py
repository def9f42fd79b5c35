"""The assignment that submitted files belong to."""

import re
from collections.abc import Sequence
from pathlib import Path

from exercises.authoring.assignments.assignment import Assignment, InvalidAssignment, NoAssignment
from exercises.authoring.assignments.catalogue import find, folders, load_catalogue, selected, slug_of
from service.grading.submission import DEFAULT_SIZES

WORD = re.compile(r"\w+")
DEFINED = re.compile(
    r"(?<![^\n\"])(?:def|class) +(\w+)|(?:(?<![^\n\"])|(?<== ))(\w+)(?= *(?::[^=\n]*)?=(?!=))"
)
"""A function, a class or a variable that a cell defines outside of functions, in a script or in a notebook's
JSON.
"""


def find_assignment(slug: str | None, files: Sequence[Path]) -> Assignment:
    """Return the assignment ``slug``, and load no other one that cannot be meant.

    For None, return the assignment whose folder contains the files; else the only assignment; else the only
    one with a function that the files define, or, if none has one, that they name. Raises NoAssignment if
    none or several match, InvalidAssignment for a broken one.
    """
    if slug is not None:
        return find(slug)
    homes = [f for f in folders() if all(file.resolve().is_relative_to(f.resolve()) for file in files)]
    likely = homes or selected()
    if len(likely) > 1 and not homes:
        texts, sources = [_text(file) for file in files], {folder: _source(folder) for folder in likely}
        for pattern in (DEFINED, WORD):
            names = {found[found.lastindex or 0] for text in texts for found in pattern.finditer(text)}
            if likely := [
                folder
                for folder, source in sources.items()
                if _names(source, names) and _asks_for(slug_of(folder), names)
            ]:
                break
    if len(likely) == 1:
        return find(slug_of(likely[0]))
    known, invalid = load_catalogue()
    broken = "".join(f"; {error}" for error in invalid.values())
    raise NoAssignment(
        f"cannot determine the assignment: give --assignment {' or '.join(sorted(known)) or 'SLUG'}{broken}"
    )


def _text(file: Path) -> str:
    with file.open("rb") as stream:
        return (
            stream.read(DEFAULT_SIZES.upload).decode("utf-8", "replace").replace("\\n", "\n")
        )  # as JSON ends a line


def _source(folder: Path) -> str:
    """Return the code of an assignment, without its samples. It contains the names of the functions that are
    asked for.
    """
    own = [file for file in folder.rglob("*.py") if "samples" not in file.relative_to(folder).parts]
    return "\n".join(
        file.read_text(encoding="utf-8", errors="replace") for file in [*own, *folder.glob("*.ipynb")]
    )


def _names(source: str, names: set[str]) -> bool:
    """Return whether the source contains one of the names as a whole word."""
    return any(name in source and re.search(rf"\b{name}\b", source) for name in names)


def _asks_for(slug: str, names: set[str]) -> bool:
    """Return whether an assignment asks for one of these functions. A broken one may."""
    try:
        return bool(find(slug).functions() & names)
    except InvalidAssignment:
        return True
