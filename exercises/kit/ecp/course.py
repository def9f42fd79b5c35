"""Which server and which assignment a notebook talks about, and the assignments whose public checks the kit carries."""

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
from ecp.outcome import Diagnosis

Diagnose = Callable[[str, Mapping[str, Any], Arrays, Arrays], list[Diagnosis]]
"""Called with a scene's name, its inputs, what it returned and the exact arrays; returns the likely causes."""
FOLDER = Path(__file__).parent / "assignments"


class UnknownCourse(NotebookError):
    """The kit has no such assignment or exercise, or does not know the server; the message says what to do."""


@dataclass(frozen=True)
class Course:
    """Where a notebook submits to. ``server`` has no slash at its end."""

    server: str | None = None
    assignment: str | None = None


@dataclass(frozen=True)
class PublicScene:
    """A scene everybody knows: ``play`` calls ``function`` with ``inputs``; of the exact arrays in ``truth`` some are ``known``.

    It is played if the one it comes ``after`` was finished; the server gives it ``budget_s`` seconds.
    """

    name: str
    play: str
    function: str
    inputs: Mapping[str, Any]
    known: list[str]
    budget_s: float
    after: str | None
    truth: Arrays


def _no_diagnosis(scene: str, inputs: Mapping[str, Any], seen: Arrays, truth: Arrays) -> list[Diagnosis]:
    return []


@dataclass(frozen=True)
class PublicAssignment:
    """The public side of an assignment, as it was when the kit was made."""

    slug: str
    version: str
    hidden: Mapping[str, int]
    exercises: tuple[Exercise, ...]
    scenes: Mapping[str, PublicScene]
    plays: Mapping[str, Any]
    diagnose: Diagnose = _no_diagnosis


_connected: list[Course] = [Course()]


def connect(server: str | None = None, assignment: str | None = None) -> None:
    """Say once where this notebook submits to; ``check``, ``submit``, ``login`` and ``attempts`` then need not be told."""
    _connected[0] = Course(_address(server) if server else None, assignment)


def server(given: str | None = None) -> str:
    """The server meant, without a slash at its end: given, connected, in POLHODE_SERVER, or the one the kit came from."""
    found = given or _connected[0].server or os.environ.get("POLHODE_SERVER") or _made().get("server")
    if not found:
        raise UnknownCourse('Say which server: ecp.connect("http://…").')
    return _address(found)


def assignment(given: str | None = None) -> str:
    """The assignment meant: given, connected, or the only one this kit knows."""
    if found := given or _connected[0].assignment:
        return found
    if len(known := slugs()) == 1:
        return known[0]
    raise UnknownCourse('Say which assignment this is: ecp.connect("http://…", assignment="…").')


def public(slug: str) -> PublicAssignment:
    """The public side of an assignment; NotKnown if this kit was made without it."""
    if slug not in slugs():
        known = f"it knows {', '.join(slugs())}" if slugs() else "it carries none: was it installed from the course's server?"
        raise UnknownCourse(f"this kit cannot check {slug} here, {known}")
    return _load(slug)


def functions(slug: str) -> set[str]:
    """Names of the functions that an assignment asks for; none where this kit does not know it."""
    return {f for e in public(slug).exercises for f in e.asks_for()} if slug in slugs() else set()


def slugs() -> list[str]:
    """Assignments this kit can check here."""
    return sorted(path.parent.name.replace("_", "-") for path in FOLDER.glob("*/public.json"))


def build() -> str | None:
    """What this kit was made of, as a hash; None where it runs from its source."""
    return _made().get("build")


def _address(told: str) -> str:
    address = told.strip().rstrip("/")
    if not address.startswith(("http://", "https://")):
        raise UnknownCourse(f"{address} is no address of a server: it begins with http:// or https://")
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
    module = importlib.import_module(f"ecp.assignments.{name}")
    with np.load(FOLDER / name / "truth.npz", allow_pickle=False) as archive:
        arrays = {key: archive[key] for key in archive.files}
    scenes = {}
    for scene in declared["scenes"]:
        truth = {key.split("/")[1]: array for key, array in arrays.items() if key.startswith(f"{scene['name']}/")}
        scenes[scene["name"]] = PublicScene(**scene | {"truth": truth})
    plays: dict[str, Any] = {"__name__": "plays"}
    exec(compile((FOLDER / name / "plays.py").read_bytes(), "plays.py", "exec"), plays)
    diagnose = getattr(module, "diagnose", _no_diagnosis)
    return PublicAssignment(slug, declared["version"], declared["hidden"], module.EXERCISES, scenes, plays, diagnose)
