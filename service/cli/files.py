"""The submissions that somebody names on a command line: files, folders of them, and patterns a shell has left as they are."""

import glob
import os
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from exercises.assignment import Assignment, NoAssignment
from exercises.catalogue import find, load_catalogue, slug_of
from exercises.catalogue import folders as assignment_folders
from service.grading.submission import MOST_BYTES

SUFFIXES = (".py", ".ipynb")


class NoSubmissionFound(ValueError):
    """A name that leads to no submission; the message tells which."""


def find_files(named: Iterable[str]) -> list[Path]:
    """The files, each once: those named, and in folders and below them every .py and .ipynb that is not hidden, by name.

    A link is followed only where it is named itself: in a folder it could be a student's, and lead to another's file or away.
    NothingFound where a name leads to none; OSError for a folder that cannot be listed, whose files would be passed over.
    """
    load_catalogue: dict[Path, Path] = {}
    for name in named:
        files = list(_files(name))
        if not files:
            raise NoSubmissionFound(f"{name}: {'no .py or .ipynb file in it' if Path(name).is_dir() else 'there is no such file'}")
        for file in files:
            load_catalogue.setdefault(file.resolve(), file)
    return list(load_catalogue.values())


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
    load_catalogue: list[Path] = []
    for here, folders, names in os.walk(folder, onerror=_raise):
        folders[:] = filter(_seen, folders)
        load_catalogue += filter(_is_one, (Path(here, name) for name in names if _seen(name)))
    return sorted(load_catalogue)


def _raise(error: OSError) -> None:
    raise error


def _seen(name: str) -> bool:
    return not name.startswith((".", "__"))


def _is_one(file: Path) -> bool:
    return file.suffix.lower() in SUFFIXES and not file.is_symlink() and file.is_file()


def resolve_assignment(slug: str | None, files: Sequence[Path]) -> Assignment:
    """The assignment ``slug``; or, for None, that whose folder the files lie in, the only one there is, or, if none is broken, the
    only one whose functions they name. NoAssignment where that is not one, InvalidAssignment for a broken one.
    """
    if slug is not None:
        return find(slug)
    homes = [f for f in assignment_folders() if all(file.resolve().is_relative_to(f.resolve()) for file in files)]
    known, invalid = load_catalogue()
    if len(only := [slug_of(home) for home in homes] or [*known, *invalid]) == 1:
        return find(only[0])
    words = {word for file in files for word in _words(file)}
    likely = [a for a in known.values() if a.functions() & words]
    if len(likely) == 1 and not invalid:
        return likely[0]
    told = "".join(f"; {error}" for error in invalid.values())
    raise NoAssignment(f"which assignment are they for? Say --assignment {' or '.join(sorted(known)) or '…'}{told}")


def _words(file: Path) -> set[str]:
    with file.open("rb") as stream:
        return set(re.findall(r"\w+", stream.read(MOST_BYTES).decode("utf-8", "replace")))
