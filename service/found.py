"""The submissions that somebody names on a command line: files, folders of them, and patterns a shell has left as they are."""

import glob
import os
from collections.abc import Iterable, Iterator
from pathlib import Path

SUFFIXES = (".py", ".ipynb")


class NothingFound(ValueError):
    """A name that leads to no submission; the message tells which."""


def find(named: Iterable[str]) -> list[Path]:
    """The files, each once: those named, and in folders and below them every .py and .ipynb that is not hidden, by name.

    A link is followed only where it is named itself: in a folder it could be a student's, and lead to another's file or away.
    NothingFound where a name leads to none; OSError for a folder that cannot be listed, whose files would be passed over.
    """
    found: dict[Path, Path] = {}
    for name in named:
        files = list(_files(name))
        if not files:
            raise NothingFound(f"{name}: {'no .py or .ipynb file in it' if Path(name).is_dir() else 'there is no such file'}")
        for file in files:
            found.setdefault(file.resolve(), file)
    return list(found.values())


def _files(name: str) -> Iterator[Path]:
    path = Path(name)
    if path.is_file():
        yield path
    elif path.is_dir():
        yield from _below(path)
    elif glob.has_magic(name):
        fixed = next(k for k, part in enumerate(path.parts) if glob.has_magic(part))
        for match in sorted(map(Path, glob.glob(name, recursive=True))):
            told = [Path(*match.parts[:end]) for end in range(fixed + 1, len(match.parts) + 1)]  # by the pattern's signs
            if any(part.is_symlink() or part.name.startswith("__") for part in told):  # glob itself leaves out what is hidden
                continue
            if match.is_dir():
                yield from _below(match)
            elif _is_one(match):
                yield match


def _below(folder: Path) -> list[Path]:
    """Also where the folder itself is hidden. Checkpoints of Jupyter and files such as __init__.py are none."""
    found: list[Path] = []
    for here, folders, names in os.walk(folder, onerror=_raise):
        folders[:] = filter(_seen, folders)
        found += filter(_is_one, (Path(here, name) for name in names if _seen(name)))
    return sorted(found)


def _raise(error: OSError) -> None:
    raise error


def _seen(name: str) -> bool:
    return not name.startswith((".", "__"))


def _is_one(file: Path) -> bool:
    return file.suffix.lower() in SUFFIXES and not file.is_symlink() and file.is_file()
