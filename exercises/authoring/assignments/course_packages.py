"""The course's own packages, which its notebooks import: the folders ``course`` beside the assignments, used
as they are in the sandbox and by students, who find them after all that is installed.

Where none is beside them, an assignment's own folder ``course`` provides its packages.
"""

from collections.abc import Collection, Iterator
from pathlib import Path

from exercises.authoring.assignments import catalogue

FOLDER = "course"
LEFT_OUT = "__pycache__"


def folders() -> list[Path]:
    """Return the folders in the order in which packages are looked for."""
    homes = catalogue.folders()
    found = [home.parent / FOLDER for home in homes] + [home / FOLDER for home in homes]
    return [folder for folder in dict.fromkeys(found) if folder.is_dir()]


def names(*more: Path) -> set[str]:
    """Return the names of the packages and modules in them, and in the folders ``more`` that exist."""
    known = [*folders(), *(folder for folder in more if folder.is_dir())]
    return {path.stem for folder in known for path in folder.iterdir() if _is_importable(path)}


def sources(imported: Collection[str], *more: Path) -> Iterator[Path]:
    """Yield the Python files of the packages and modules among these names, in them and in ``more``."""
    for folder in [*folders(), *(folder for folder in more if folder.is_dir())]:
        for path in folder.iterdir():
            if path.stem in imported and _is_importable(path):
                yield from path.rglob("*.py") if path.is_dir() else (path,)


def files() -> dict[str, bytes]:
    """Return the content of all packages by path; of two with one name the first is taken."""
    found = dict[str, bytes]()
    for folder in reversed(folders()):
        own = dict(_files(folder))
        tops = {name.partition("/")[0] for name in own}
        found = {name: content for name, content in found.items() if name.partition("/")[0] not in tops} | own
    return found


def _files(folder: Path) -> Iterator[tuple[str, bytes]]:
    for path in sorted(folder.rglob("*")):
        inside = path.relative_to(folder)
        hidden = any(part == LEFT_OUT or part.startswith(".") for part in inside.parts)
        if path.is_file() and not hidden:
            yield inside.as_posix(), path.read_bytes()


def _is_importable(path: Path) -> bool:
    return path.suffix == ".py" or (path / "__init__.py").is_file()
