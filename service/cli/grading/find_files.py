"""The files named on a command line that can be submissions.

It imports only the standard library: Gradescope's program calls it before it knows that libraries can be
imported.
"""

import glob
import os
from collections.abc import Iterable, Iterator
from pathlib import Path

from service.cli.errors import CommandError

SUFFIXES, JSON = (".py", ".ipynb"), ".json"


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
