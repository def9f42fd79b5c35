"""The course's own packages, which its notebooks import: the folders ``course`` beside the assignments, used
as they are in the sandbox and by students, who find them after all that is installed.

Where none is beside them, an assignment's own folder ``course`` provides its packages.
"""

import functools
import sys
from collections import defaultdict
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path

from exercises.authoring.assignments import catalogue
from exercises.authoring.assignments.catalogue import course_folders
from exercises.authoring.assignments.course_imports import ALWAYS
from exercises.authoring.importing.validation_words import COURSE_FOLDER
from polhode.judging.claims import words_in

LEFT_OUT = "__pycache__"
OTHERS = dict.fromkeys(sys.stdlib_module_names, "a module of the standard library")
OTHERS |= dict.fromkeys(ALWAYS, "a package that every notebook can use") | {
    "polhode": "the students' kit",
    "guest": "a package of the sandbox",
}
"""What comes before a course's package, by its name."""
COMPILED = (".so", ".pyd", ".dylib")


def names(*more: Path) -> set[str]:
    """Return the names of the packages and modules in them, and in the folders ``more`` that exist."""
    known = [*course_folders(), *(folder for folder in more if folder.is_dir())]
    return {path.stem for folder in known for path in folder.iterdir() if _is_importable(path)}


def modules() -> set[str]:
    """Return the names of the packages and modules in them of which ``errors`` says nothing, and of their
    modules with the validation words.
    """
    paths = [path for folder in course_folders() for path in folder.iterdir() if _is_importable(path)]
    found = {path.stem for path in paths if _is_free(path) and not any(_syntax_errors(path))}
    words = set[str]().union(*map(words_in, course_folders()))
    return found | {name for name in words if name.partition(".")[0] in found}


def errors() -> tuple[str, ...]:
    """Return why packages in them cannot be used: a sentence for each, with its file and what to do."""
    return _errors(
        tuple(home.parent / COURSE_FOLDER for home in catalogue.folders()), tuple(course_folders())
    )


@functools.cache
def _errors(beside: Sequence[Path], known: Sequence[Path]) -> tuple[str, ...]:
    found, places = list[str](), defaultdict[tuple[bool, str], list[Path]](list)
    for folder in known:
        for path in sorted(path for path in folder.iterdir() if _is_importable(path)):
            places[folder in beside, path.stem].append(path)
            if other := OTHERS.get(path.stem):
                found.append(f"{path} has the name of {other}, which comes before it: rename it")
            elif not path.stem.isidentifier():
                found.append(f"{path} cannot be imported: rename it to a name of letters, digits and _")
            found += _syntax_errors(path)
    for (_, name), places_of in places.items():
        if len({_content(path) for path in places_of}) > 1:
            used, *others = places_of
            found.append(
                f"the course's package {name} exists in {used}, which is used, and in"
                f" {', '.join(map(str, others))}: remove one"
            )
    return tuple(found)


def remarks() -> list[str]:
    """Return what works on this server and may not work for students: a sentence for each compiled file."""
    return [
        f"{path} is compiled: students with another system or Python than this server's cannot import it, so"
        " give them the same in Python, or a distribution to install"
        for folder in course_folders()
        for path in sorted(folder.rglob("*"))
        if path.suffix in COMPILED
    ]


def _is_free(path: Path) -> bool:
    return path.stem.isidentifier() and path.stem not in OTHERS


def _syntax_errors(path: Path) -> Iterator[str]:
    for file in sorted(path.rglob("*.py")) if path.is_dir() else [path]:
        try:
            compile(file.read_bytes(), str(file), "exec", dont_inherit=True)
        except (SyntaxError, ValueError, OSError) as error:  # with zero bytes it has no line
            line = f", line {at}" if (at := getattr(error, "lineno", None)) else ""
            yield f"{file}{line}: {getattr(error, 'msg', None) or error}"


def _content(path: Path) -> tuple[tuple[str, bytes], ...]:
    """Return the files of a package or module."""
    if path.is_file():
        return ((path.name, path.read_bytes()),)
    return tuple(sorted(_files(path)))


def sources(imported: Collection[str], *more: Path) -> Iterator[Path]:
    """Yield the Python files of the packages and modules among these names, in them and in ``more``."""
    for folder in [*course_folders(), *(folder for folder in more if folder.is_dir())]:
        for path in folder.iterdir():
            if path.stem in imported and _is_importable(path):
                yield from path.rglob("*.py") if path.is_dir() else (path,)


def files() -> dict[str, bytes]:
    """Return the content of all packages by path; of two with one name the first is taken."""
    found = dict[str, bytes]()
    for folder in reversed(course_folders()):
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
