"""The validation words of a course, with their parameters: read from the source of the course's package,
which the server never imports.

``polhode.judging.claims.words_in`` says which functions are words.
"""

import ast
import functools
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from polhode.judging.claims import KINDS, MODULE, words_in

COURSE_FOLDER = "course"
USUAL = """
def check(passed, label, detail="", *, strict=True): ...
def close(got, expected, label, *, rtol=1e-6, atol=1e-9, strict=True): ...
def conserved(series, label, *, rel_drift=1e-4, strict=True): ...
def positive(value, label, *, strict=True): ...
def below(value, limit, label, detail="", *, strict=True): ...
"""
"""The words as courses have them, for a package that is not at hand."""


class Word(NamedTuple):
    """A word: its name, its positional parameters, and the default of each parameter that has one."""

    name: str
    parameters: tuple[str, ...]
    defaults: tuple[tuple[str, ast.expr], ...]


Words = tuple[tuple[str, tuple[Word, ...]], ...]
"""The words by the last part of their module's name."""


def course_words(folder: Path) -> Words:
    """Return the words of the assignment in ``folder``: those of the course beside it, then its own."""
    return words(_course_folders(folder))


def course_packages(folder: Path) -> set[str]:
    """Return the names of the course's packages and modules that the assignment in ``folder`` can import."""
    found = [path for home in _course_folders(folder) for path in home.glob("[!_.]*")]
    return {path.stem for path in found if path.suffix == ".py" or any(path.glob("*.py"))}


def _course_folders(folder: Path) -> tuple[Path, Path]:
    return folder.parent / COURSE_FOLDER, folder / COURSE_FOLDER


def words(folders: Iterable[Path]) -> Words:
    """Return the words of the packages in these folders, of which the first that has a module counts."""
    return _words(tuple(folder for folder in folders if folder.is_dir()))


@functools.lru_cache(maxsize=64)
def _words(folders: tuple[Path, ...]) -> Words:
    found = {MODULE: {name: word for name, word in _read(USUAL).items() if name in KINDS}}
    for folder in reversed(folders):
        for module, names in words_in(folder).items():
            path = folder.joinpath(*module.split(".")).with_suffix(".py")
            try:
                defined = _read(path.read_text(encoding="utf-8"))
            except (OSError, SyntaxError, ValueError):
                defined = {}
            last = module.rpartition(".")[2]
            own = {name: defined.get(name, Word(name, (), ())) for name in names if name in defined}
            found[last] = found.get(last, {}) | own
    return tuple((module, tuple(known.values())) for module, known in found.items())


def _read(source: str) -> dict[str, Word]:
    """Return the functions that a module defines."""
    found = {}
    for node in ast.parse(source).body:
        if isinstance(node, ast.FunctionDef):
            parameters = [parameter.arg for parameter in (*node.args.posonlyargs, *node.args.args)]
            defaults = list(zip(reversed(parameters), reversed(node.args.defaults), strict=False))
            named = [parameter.arg for parameter in node.args.kwonlyargs]
            defaults += [(k, v) for k, v in zip(named, node.args.kw_defaults, strict=True) if v is not None]
            found[node.name] = Word(node.name, tuple(parameters), tuple(defaults))
    return found
