"""The submissions that somebody names on a command line: files, folders of them, and patterns a shell has left as they are."""

import glob
from collections.abc import Iterable, Iterator
from pathlib import Path

SUFFIXES = (".py", ".ipynb")


class NothingFound(ValueError):
    """A name that leads to no submission; the message tells which."""


def find(named: Iterable[str]) -> list[Path]:
    """The files, each once: those named, and in folders and below them every .py and .ipynb that is not hidden, by name.

    NothingFound where a name leads to none.
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
        for match in sorted(map(Path, glob.glob(name, recursive=True))):
            if match.is_dir():
                yield from _below(match)
            elif _is_one(match, match):
                yield match


def _below(folder: Path) -> list[Path]:
    """Also where the folder itself is hidden."""
    return sorted(file for file in folder.rglob("*") if _is_one(file, file.relative_to(folder)))


def _is_one(file: Path, seen: Path) -> bool:
    """Checkpoints of Jupyter and files such as __init__.py are none."""
    hidden = any(part.startswith((".", "__")) and part != ".." for part in seen.parts)
    return file.suffix in SUFFIXES and not hidden and file.is_file()
