"""The files named on a command line, and the assignment they belong to."""

import glob
import os
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from service.cli.errors import CommandError

if TYPE_CHECKING:
    from exercises.authoring.assignments.assignment import Assignment

SUFFIXES, JSON = (".py", ".ipynb"), ".json"
WORD = re.compile(r"\w+")
DEFINED = re.compile(
    r"(?<![^\n\"])(?:def|class) +(\w+)|(?:(?<![^\n\"])|(?<== ))(\w+)(?= *(?::[^=\n]*)?=(?!=))"
)
"""A function, a class or a variable that a cell defines outside of functions, in a script or in a notebook's
JSON.
"""


class NoSubmissionFound(CommandError):
    """A name matches no file that can be a submission; the message says which."""


def find_files(named: Iterable[str]) -> list[Path]:
    """Return the named files, each once, in order.

    A folder stands for all .py and .ipynb files in it and below that are not hidden, sorted by name. A
    symbolic link is followed only if it is named itself: inside a folder a student's link could lead to
    another student's file. Raises NoSubmissionFound if a name matches nothing or a file that is neither .py,
    .ipynb nor .json, OSError for a folder that cannot be listed.
    """
    found: dict[Path, Path] = {}
    for name in named:
        files = list(_files(name))
        if not files:
            raise NoSubmissionFound(
                f"{name}: {'no .py or .ipynb file in this folder' if Path(name).is_dir() else 'no such file'}"
            )
        if other := [file.name for file in files if file.suffix.lower() not in (*SUFFIXES, JSON)]:
            raise NoSubmissionFound(
                f"{', '.join(other)}: cannot be a submission: name a .py, .ipynb or .json file; if it holds"
                " Python, rename it to end in .py"
            )
        for file in files:
            found.setdefault(file.resolve(), file)
    return list(found.values())


def _files(name: str) -> Iterator[Path]:
    path = Path(name)
    if path.is_file():
        yield path
    elif path.is_dir():
        yield from _in_folder(path)
    elif glob.has_magic(name):
        fixed = next(k for k, part in enumerate(path.parts) if glob.has_magic(part))
        for match in sorted(map(Path, glob.glob(name, recursive=True))):
            matched = [
                Path(*match.parts[:end]) for end in range(fixed + 1, len(match.parts) + 1)
            ]  # parts matched by wildcards
            if any(
                part.is_symlink() or part.name.startswith("__") for part in matched
            ):  # glob itself skips hidden files
                continue
            if match.is_dir():
                yield from _in_folder(match)
            elif _is_submission(match):
                yield match


def _in_folder(folder: Path) -> list[Path]:
    """Return the files in a folder, which may itself be hidden, without Jupyter's checkpoints and files such
    as __init__.py.
    """
    found: list[Path] = []
    for here, folders, names in os.walk(folder, onerror=_raise):
        folders[:] = filter(_visible, folders)
        found += filter(_is_submission, (Path(here, name) for name in names if _visible(name)))
    return sorted(found)


def _raise(error: OSError) -> None:
    raise error


def _visible(name: str) -> bool:
    return not name.startswith((".", "__"))


def _is_submission(file: Path) -> bool:
    return file.suffix.lower() in SUFFIXES and not file.is_symlink() and file.is_file()


def resolve_assignment(slug: str | None, files: Sequence[Path]) -> "Assignment":
    """Return the assignment ``slug``, and load no other one that cannot be meant.

    For None, return the assignment whose folder contains the files; else the only assignment; else the only
    one with a function that the files define, or, if none has one, that they name. Raises NoAssignment if
    none or several match, InvalidAssignment for a broken one.
    """
    from exercises.authoring.assignments.assignment import NoAssignment
    from exercises.authoring.assignments.catalogue import find, folders, load_catalogue, selected, slug_of

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
    from service.grading.submission import DEFAULT_SIZES

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
    from exercises.authoring.assignments.assignment import InvalidAssignment
    from exercises.authoring.assignments.catalogue import find

    try:
        return bool(find(slug).functions() & names)
    except InvalidAssignment:
        return True
