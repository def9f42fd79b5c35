"""Discovery of assignments: the packages in ``exercises``, and those named in POLHODE_ASSIGNMENTS."""

import functools
import importlib
import importlib.machinery
import importlib.util
import os
import sys
from collections.abc import Collection
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple, cast

import exercises
from exercises.authoring.assignments import validation
from exercises.authoring.assignments.assignment import Assignment, InvalidAssignment, NoAssignment
from exercises.authoring.assignments.course_imports import distributions
from exercises.authoring.assignments.listing_index import IndexedAssignment, read_index, write_index
from exercises.authoring.assignments.validation import format_error, syntax_errors
from exercises.authoring.importing.validation_words import COURSE_FOLDER
from exercises.authoring.notebook_declaration import Notebook

SETTING, COURSE = "POLHODE_ASSIGNMENTS", "POLHODE_COURSE"
DECLARATION = "assignment.py"


def folders() -> list[Path]:
    """Return every folder of an assignment, valid or not, those in ``exercises`` first."""
    return list(dict.fromkeys([*_here(), *(folder for one in _named() for folder in discover(one))]))


def course_folders() -> list[Path]:
    """Return the folders with the course's own packages, in the order in which these are looked for: those
    beside assignments, then those of single assignments.
    """
    homes = folders()
    found = [home.parent / COURSE_FOLDER for home in homes] + [home / COURSE_FOLDER for home in homes]
    return [folder for folder in dict.fromkeys(found) if folder.is_dir()]


def is_taken(slug: str) -> bool:
    """Return whether an assignment or a module of ``exercises`` has that name."""
    name = slug.replace("-", "_")
    return (
        name in [folder.name for folder in folders()]
        or importlib.util.find_spec(f"exercises.{name}") is not None
    )


def default_folder() -> Path | None:
    """Return where a new assignment belongs: the first folder of assignments in POLHODE_ASSIGNMENTS, else
    that of ``exercises``.

    Return None if polhode is installed as a package and no such folder is set.
    """
    for named in _named():
        if not (named / "__init__.py").is_file():
            return named
    here = Path(exercises.__path__[0])
    return None if {"site-packages", "dist-packages"} & set(here.parts) else here


def register_folder(folder: Path) -> None:
    """Add the assignment in ``folder`` to the catalogue of this process and of those it starts."""
    known = os.environ.get(SETTING)
    os.environ[SETTING] = os.pathsep.join([*([known] if known else []), str(folder.resolve())])
    load_catalogue.cache_clear()


def slug_of(folder: Path) -> str:
    """Return the slug of the assignment in ``folder``."""
    return folder.name.replace("_", "-")


def load(folder: Path) -> tuple[Any, list[str]]:
    """Import the folder as a part of ``exercises`` and return the assignment that its assignment.py declares,
    or None and all errors that prevent it.
    """
    errors = [] if (folder / DECLARATION).is_file() else [f"{DECLARATION} is missing"]
    if not folder.is_dir():
        errors = [f"there is no folder {folder}"]
    if not (
        folder.name.isidentifier() and folder.name.isascii() and folder.name == folder.name.lower().strip("_")
    ):
        rule = "use lower-case letters from a to z, digits, and _ between them"
        errors.append(f"its folder's name {folder.name} is not a package name: {rule}")
    if errors := errors or _taken(folder):
        return None, [*errors, *syntax_errors(folder)]
    try:
        declared = vars(_imported(folder)).values()
    except (Exception, SystemExit):
        if errors := syntax_errors(folder):
            return None, errors
        raise
    own = [
        module for name, module in list(sys.modules.items()) if name.startswith(f"exercises.{folder.name}.")
    ]
    if errors := syntax_errors(folder, [str(module.__file__) for module in own]):
        return None, errors
    notebooks = [value for value in declared if isinstance(value, Notebook)]
    if len(notebooks) != 1:
        return None, [f"{DECLARATION} makes {len(notebooks)} notebooks; it must make one"]
    errors = notebooks[0].errors(folder)
    return (None, errors) if errors else (notebooks[0].assignment(folder), [])


def discover(named: Path) -> list[Path]:
    """Return the assignment that a folder is, or every assignment in it. A folder that does not exist is
    returned itself.
    """
    if not named.is_dir() or any((named / one).exists() for one in (DECLARATION, "__init__.py", "samples")):
        return [named]
    return sorted(path.parent for path in named.glob(f"*/{DECLARATION}"))


def _here() -> list[Path]:
    """Return the folders of assignments in this package."""
    return sorted(
        {path.parent for root in exercises.__path__ for path in Path(root).glob(f"*/{DECLARATION}")}
    )


def _named() -> list[Path]:
    return [
        Path(part).expanduser().resolve() for part in os.environ.get(SETTING, "").split(os.pathsep) if part
    ]


def _taken(folder: Path) -> list[str]:
    """Return an error if ``exercises`` already has another module of that name."""
    spec = importlib.util.find_spec(f"exercises.{folder.name}")
    found = [] if spec is None else list(spec.submodule_search_locations or [str(spec.origin)])
    if not found or str(folder) in found:
        return []
    return [f"the name {folder.name} is already used by {found[0]}: choose another"]


def _imported(folder: Path) -> ModuleType:
    """Import the folder's assignment.py as a module of the package ``exercises.NAME``, from any folder. The
    packages next to it are not imported.
    """
    name = f"exercises.{folder.name}"
    if name not in sys.modules:
        spec = importlib.machinery.ModuleSpec(name, None, is_package=True)
        spec.submodule_search_locations = [str(folder)]
        sys.modules[name] = importlib.util.module_from_spec(spec)
    return importlib.import_module(f"{name}.assignment")


class Catalogue(NamedTuple):
    """The valid assignments, and the invalid ones with their errors, each by its slug."""

    valid: dict[str, Assignment]
    invalid: dict[str, InvalidAssignment]


def assignments() -> dict[str, Assignment]:
    """Return every valid assignment by its slug."""
    return load_catalogue().valid


def find(slug: str) -> Assignment:
    """Return the assignment of that slug or folder name, and load no other. Raises InvalidAssignment if it is
    invalid, NoAssignment if there is none.
    """
    slug = slug.replace("_", "-")
    for folder in selected():
        if slug_of(folder) == slug:
            if isinstance(found := _load(folder), InvalidAssignment):
                raise found
            return found
    valid, invalid = load_catalogue()
    if slug in invalid:
        raise invalid[slug]
    known = ", ".join(sorted(valid)) or "none"
    raise NoAssignment(
        f"there is no assignment {slug}; known: {known}; name the folder of another one in {SETTING}"
    )


@functools.cache
def load_catalogue() -> Catalogue:
    """Load each package in ``exercises`` and each that POLHODE_ASSIGNMENTS names, or of these the slugs in
    POLHODE_COURSE, in their order. An invalid one does not affect the others.
    """
    more = distributions(tuple(course_folders()))
    loaded = [(slug_of(folder), _listed(folder, more)) for folder in selected()]
    absent = set(_chosen()) - {slug for slug, _ in loaded}
    invalid = {
        slug: InvalidAssignment(slug, [f"{COURSE} names it, but it does not exist"]) for slug in absent
    }
    invalid.update((slug, error) for slug, error in loaded if isinstance(error, InvalidAssignment))
    valid = {slug: found for slug, found in loaded if not isinstance(found, InvalidAssignment)}
    return Catalogue(valid, invalid)


def _chosen() -> list[str]:
    return os.environ.get(COURSE, "").split()


def selected() -> list[Path]:
    """Return the folders of the course's assignments in its order,
    all folders if POLHODE_COURSE is not set.
    """
    found, order = folders(), {slug: k for k, slug in enumerate(_chosen())}
    return (
        sorted([one for one in found if slug_of(one) in order], key=lambda one: order[slug_of(one)])
        if order
        else found
    )


def _listed(folder: Path, more: Collection[str]) -> Assignment | InvalidAssignment:
    """Return an assignment for lists: one that is loaded later if it has a valid index."""
    if (index := read_index(folder)) is None:
        return _load(folder)
    return cast("Assignment", IndexedAssignment(folder, index, more, lambda: find(slug_of(folder))))


@functools.cache
def _load(folder: Path) -> Assignment | InvalidAssignment:
    slug = slug_of(folder)
    try:
        assignment, errors = load(folder)
        errors = errors or validation.errors(assignment)
        if not errors and read_index(folder) is None:
            write_index(assignment)
        if not errors and (more := distributions(tuple(course_folders()))):
            assignment = replace(assignment, packages=tuple(dict.fromkeys([*assignment.packages, *more])))
    except InvalidAssignment as error:
        errors = error.errors
    except (Exception, SystemExit) as error:
        errors = [format_error(error, folder)]
    return InvalidAssignment(slug, errors) if errors else assignment
