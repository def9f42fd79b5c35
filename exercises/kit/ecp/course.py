"""The server and assignment of a notebook, and the assignments whose public checks the kit contains."""

import importlib
import json
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from ecp.checks import Arrays
from ecp.errors import NotebookError
from ecp.exercise import Exercise
from ecp.kinds import diagnose, exercise
from ecp.outcome import Diagnosis

Diagnose = Callable[[str, Mapping[str, Any], Arrays, Arrays], list[Diagnosis]]
"""Called with a scene's name, its inputs, what it returned and the exact arrays; returns the likely causes."""
FOLDER = Path(__file__).parent / "assignments"


class UnknownCourse(NotebookError):
    """The server, assignment or exercise is not known; the message says what to do."""


@dataclass(frozen=True)
class Course:
    """The server and assignment a notebook submits to. ``server`` has no trailing slash."""

    server: str | None = None
    assignment: str | None = None


@dataclass(frozen=True)
class PublicScene:
    """A scene with fixed inputs: ``play`` calls ``function`` with ``inputs``. ``truth`` holds the exact
    arrays.

    The arrays named in ``known`` are added to those the function returned. The scene runs only if the scene
    it comes ``after`` has finished. The server gives it ``budget_s`` seconds. ``question`` is its question, if it
    has one (ecp.kinds).
    """

    name: str
    play: str
    function: str
    inputs: Mapping[str, Any]
    known: list[str]
    budget_s: float
    after: str | None
    truth: Arrays
    question: Mapping[str, Any] | None = None


def _no_diagnosis(scene: str, inputs: Mapping[str, Any], seen: Arrays, truth: Arrays) -> list[Diagnosis]:
    return []


@dataclass(frozen=True)
class PublicAssignment:
    """The public side of an assignment, as of the kit's build. ``hidden`` counts each exercise's hidden checks."""

    slug: str
    version: str
    hidden: Mapping[str, int]
    exercises: tuple[Exercise, ...]
    scenes: Mapping[str, PublicScene]
    plays: Mapping[str, Any]
    diagnose: Diagnose = _no_diagnosis


def _by_kind(scenes: Mapping[str, PublicScene]) -> Diagnose:
    return lambda scene, inputs, seen, truth: diagnose(scenes[scene].question or {}, seen, truth) or []


_connected: list[Course] = [Course()]


def connect(server: str | None = None, assignment: str | None = None) -> None:
    """Set the server and assignment that ``check``, ``submit``, ``login`` and ``submissions`` use by default.

    Raises UnknownCourse if ``server`` is not an http or https address.
    """
    _connected[0] = Course(_address(server) if server else None, assignment)


def server(given: str | None = None) -> str:
    """Return the server's address without a trailing slash: given, connected, from POLHODE_SERVER, or the
    kit's origin.

    Raises UnknownCourse if none of them is set.
    """
    found = given or _connected[0].server or os.environ.get("POLHODE_SERVER") or _made().get("server")
    if not found:
        raise UnknownCourse('No server is set: call ecp.connect("https://…") first.')
    return _address(found)


def assignment(given: str | None = None) -> str:
    """Return the assignment's slug: given, connected, or the only one this kit contains. Raises UnknownCourse
    otherwise.
    """
    if found := given or _connected[0].assignment:
        return found
    if len(known := slugs()) == 1:
        return known[0]
    raise UnknownCourse('No assignment is set: call ecp.connect("https://…", assignment="…") first.')


def public(slug: str) -> PublicAssignment:
    """Return the public side of an assignment. Raises UnknownCourse if this kit does not contain it."""
    if slug not in slugs():
        empty = " because it contains no assignment: install the kit from your course's server"
        known = f"; it has {', '.join(slugs())}" if slugs() else empty
        raise UnknownCourse(f"this kit has no local checks for {slug}{known}")
    return _load(slug)


def functions(slug: str) -> set[str]:
    """Return the names of the functions that an assignment asks for; empty if this kit does not contain it."""
    return {f for e in public(slug).exercises for f in e.function_names()} if slug in slugs() else set()


def slugs() -> list[str]:
    """Return the slugs of the assignments whose public checks this kit contains."""
    return sorted(path.parent.name.replace("_", "-") for path in FOLDER.glob("*/public.json"))


def build() -> str | None:
    """Return the kit's build hash, or None if it runs from its source."""
    return _made().get("build")


def _address(given: str) -> str:
    address = given.strip().rstrip("/")
    if not address.startswith(("http://", "https://")):
        raise UnknownCourse(f"{address} is not a server address: it must begin with http:// or https://")
    return address


@cache
def _made() -> dict[str, str]:
    path = FOLDER / "made.json"
    found: dict[str, str] = json.loads(path.read_bytes()) if path.is_file() else {}
    return found


@cache
def _load(slug: str) -> PublicAssignment:
    name = slug.replace("-", "_")
    declared = json.loads((FOLDER / name / "public.json").read_bytes())
    with np.load(FOLDER / name / "truth.npz", allow_pickle=False) as archive:
        arrays = {key: archive[key] for key in archive.files}
    scenes = {}
    for scene in declared["scenes"]:
        truth = {key.split("/")[1]: array for key, array in arrays.items() if key.startswith(f"{scene['name']}/")}
        scenes[scene["name"]] = PublicScene(**scene | {"truth": truth})
    plays: dict[str, Any] = {"__name__": "plays"}
    exec(compile((FOLDER / name / "plays.py").read_bytes(), "plays.py", "exec"), plays)
    if asked := declared.get("exercises"):
        exercises = tuple(exercise(e["number"], e["title"], e["questions"], False) for e in asked)
        return PublicAssignment(slug, declared["version"], declared["hidden"], exercises, scenes, plays, _by_kind(scenes))
    module = importlib.import_module(f"ecp.assignments.{name}")
    diagnose = getattr(module, "diagnose", _no_diagnosis)
    return PublicAssignment(slug, declared["version"], declared["hidden"], module.EXERCISES, scenes, plays, diagnose)
