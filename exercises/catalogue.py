"""Where assignments lie: the packages in this folder, and those that POLHODE_ASSIGNMENTS names."""

import functools
import importlib
import importlib.util
import os
import pkgutil
import sys
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import exercises
from exercises import validation
from exercises.assignment import Assignment, InvalidAssignment, NoAssignment
from exercises.validation import NEEDED, format_error, syntax_errors

SETTING = "POLHODE_ASSIGNMENTS"


def folders() -> list[Path]:
    """Every folder that means to be an assignment, those beside this file first."""
    return list(dict.fromkeys([*_here(), *(folder for one in _named() for folder in discover(one))]))


def is_taken(slug: str) -> bool:
    """Whether that name is an assignment's, or a module's of this folder."""
    name = slug.replace("-", "_")
    return name in [folder.name for folder in folders()] or importlib.util.find_spec(f"exercises.{name}") is not None


def default_folder() -> Path | None:
    """Where a new assignment belongs: in the first folder of them that POLHODE_ASSIGNMENTS names, else here, unless installed."""
    for named in _named():
        if not (named / "__init__.py").is_file():
            return named
    here = Path(__file__).parent
    return None if {"site-packages", "dist-packages"} & set(here.parts) else here


def register_folder(folder: Path) -> None:
    """Let this process, and those it starts, know the assignment in ``folder``."""
    known = os.environ.get(SETTING)
    os.environ[SETTING] = os.pathsep.join([*([known] if known else []), str(folder.resolve())])


def slug_of(folder: Path) -> str:
    """What the assignment in ``folder`` is called."""
    return folder.name.replace("_", "-")


def load(folder: Path) -> tuple[Any, list[str]]:
    """What the folder defines as ``ASSIGNMENT``, imported as a part of ``exercises``; or None and all that keeps it from that."""
    errors = [f"{name} is missing" for name in NEEDED if not (folder / name).is_file()] if folder.is_dir() else []
    if not folder.is_dir():
        errors.append(f"there is no folder {folder}")
    elif not (folder / "__init__.py").is_file():
        errors.append("__init__.py is missing")
    if not (folder.name.isidentifier() and folder.name == folder.name.lower()):
        errors.append(f"its folder {folder.name} is no name of a package: small letters, digits and _")
    errors += syntax_errors(folder)
    if errors:
        return None, errors
    if errors := _taken(folder):
        return None, errors
    module = _imported(folder)
    if not hasattr(module, "ASSIGNMENT"):
        return None, ["__init__.py defines no ASSIGNMENT"]
    return module.ASSIGNMENT, []


def discover(named: Path) -> list[Path]:
    """The assignment that a folder is, or each in a folder of them; a folder that is not there stands for itself."""
    if not named.is_dir() or any((named / file).is_file() for file in ("__init__.py", *NEEDED)):
        return [named]
    return sorted(path.parent for path in named.glob("*/__init__.py"))


def _here() -> list[Path]:
    return [Path(getattr(m.module_finder, "path", "")) / m.name for m in pkgutil.iter_modules(exercises.__path__) if m.ispkg]


def _named() -> list[Path]:
    return [Path(part).expanduser().resolve() for part in os.environ.get(SETTING, "").split(os.pathsep) if part]


def _taken(folder: Path) -> list[str]:
    """An error where ``exercises`` has something else of that name."""
    spec = importlib.util.find_spec(f"exercises.{folder.name}")
    if spec is None or spec.origin == str(folder / "__init__.py"):
        return []
    return [f"the name {folder.name} is taken: by {spec.origin or 'a folder of polhode'}"]


def _imported(folder: Path) -> ModuleType:
    """The package as one of ``exercises``, wherever it lies; its neighbours there are not."""
    name = f"exercises.{folder.name}"
    if name in sys.modules or str(folder.parent) in exercises.__path__:
        return importlib.import_module(name)
    spec = importlib.util.spec_from_file_location(name, folder / "__init__.py", submodule_search_locations=[str(folder)])
    assert spec is not None and spec.loader is not None
    sys.modules[name] = module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
    return module


class Catalogue(NamedTuple):
    """The assignments by their slugs; and those that cannot be used, with all that is wrong with each."""

    valid: dict[str, Assignment]
    invalid: dict[str, InvalidAssignment]


def assignments() -> dict[str, Assignment]:
    """Every assignment that can be used, by its slug."""
    return load_catalogue().valid


def find(slug: str) -> Assignment:
    """The assignment of that slug, or of that folder's name; InvalidAssignment for a broken one, NoAssignment for none."""
    slug = slug.replace("_", "-")
    if (error := load_catalogue().invalid.get(slug)) and slug not in load_catalogue().valid:
        raise error
    if slug not in load_catalogue().valid:
        raise NoAssignment(f"there is no assignment {slug}; known: {', '.join(sorted(load_catalogue().valid)) or 'none'}")
    return load_catalogue().valid[slug]


@functools.cache
def load_catalogue() -> Catalogue:
    """Each package in this folder, and each that POLHODE_ASSIGNMENTS names: one that is broken costs no other."""
    valid, invalid = {}, {}
    for folder in folders():
        slug = slug_of(folder)
        try:
            assignment = _load(slug, folder)
        except InvalidAssignment as error:
            invalid[slug] = error
        else:
            valid[slug] = assignment
    return Catalogue(valid, invalid)


def _load(slug: str, folder: Path) -> Assignment:
    try:
        assignment, errors = load(folder)
    except InvalidAssignment as error:
        raise InvalidAssignment(slug, error.errors) from error
    except (Exception, SystemExit) as error:
        raise InvalidAssignment(slug, [format_error(error, folder)]) from error
    if not errors and not isinstance(assignment, Assignment):
        errors = [f"ASSIGNMENT is {type(assignment).__name__}, no Assignment"]
    elif not errors and assignment.slug != slug:
        errors = [f"its slug is {assignment.slug}, but its folder's name makes it {slug}"]
    elif not errors:
        errors = validation.errors(assignment)
    if errors:
        raise InvalidAssignment(slug, errors)
    return assignment
