"""The server and assignment of a notebook, and the assignments whose kits are installed, each in its folder
below assignments/.
"""

import importlib
import json
import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from polhode import KIT
from polhode.client.data_files import MODULES, copy_data, use_modules
from polhode.client.errors import NotebookError
from polhode.judging.checks import Arrays
from polhode.judging.exercise import Exercise
from polhode.judging.outcome import Diagnosis
from polhode.kinds import diagnose, exercise

Diagnose = Callable[[str, Mapping[str, Any], Arrays, Arrays], list[Diagnosis]]
"""Called with a scene's name, its inputs, what it returned and the exact arrays; returns the likely causes.
"""
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
    """A scene with fixed inputs: ``play`` calls ``function`` with ``inputs`` and also uses the names in
    ``needs``. ``truth`` holds the exact arrays.

    The arrays named in ``known`` are added to those the function returned. The scene runs only if the scene
    it comes ``after`` has finished. The server gives it ``budget_s`` seconds. ``question`` is its question,
    if it has one (polhode.kinds). ``returns`` are shape, dtype and up_to of the arrays that its play returns.
    """

    name: str
    play: str
    function: str
    inputs: Mapping[str, Any]
    known: list[str]
    budget_s: float
    after: str | None
    truth: Arrays
    needs: list[str] = field(default_factory=list)
    question: Mapping[str, Any] | None = None
    returns: Mapping[str, Any] | None = None


@dataclass(frozen=True)
class PublicAssignment:
    """The public side of an assignment, as of the kit's build. ``hidden`` counts each exercise's hidden
    checks.
    """

    slug: str
    version: str
    hidden: Mapping[str, int]
    exercises: tuple[Exercise, ...]
    scenes: Mapping[str, PublicScene]
    plays: Mapping[str, Any]
    diagnose_own: Diagnose | None = None

    def names(self, scene: str) -> set[str]:
        """Return the notebook's names that a scene, and those it comes after, cannot be played without."""
        found = self.scenes[scene]
        return {found.function, *found.needs} | (
            self.names(found.after) if found.after is not None else set()
        )

    def diagnose(self, scene: str, seen: Arrays) -> list[Diagnosis]:
        """Return the likely causes behind what a scene returned: by its question's kind, else by the author's
        own function.
        """
        found = self.scenes[scene]
        if found.question is not None:
            return diagnose(found.question, seen, found.truth) or []
        return self.diagnose_own(scene, found.inputs, seen, found.truth) if self.diagnose_own else []

    def variables(self) -> set[str]:
        """Return the names that stand for a value, not for a function."""
        return {name for e in self.exercises for name in e.variables}


_connected: list[Course] = [Course()]


def connect(server: str | None = None, assignment: str | None = None) -> None:
    """Set the server and assignment that ``check``, ``submit``, ``login`` and ``submissions`` use by default.

    Copies the assignment's data files to the current folder and leaves those that are there already; its own
    modules can be imported from ``polhode``. Raises UnknownCourse if ``server`` is not an http or https
    address.
    """
    _connected[0] = Course(_address(server) if server else None, assignment)
    for slug in [assignment] if assignment else slugs():
        data = FOLDER / slug.replace("-", "_") / "data"
        copy_data(data)
        use_modules(data / MODULES)


def server(given: str | None = None, assignment: str | None = None) -> str:
    """Return the server's address without a trailing slash: given, connected, from POLHODE_SERVER, or the
    origin of the kit of ``assignment`` (default: connected, else of all installed kits).

    Raises UnknownCourse if none of them is set, or if the kits come from several servers.
    """
    if found := given or _connected[0].server or os.environ.get("POLHODE_SERVER"):
        return _address(found)
    slug = assignment or _connected[0].assignment
    origins = _origins([slug] if slug else []) or _origins(slugs())
    if len(origins) == 1:
        return _address(origins.pop())
    several = f" (the installed kits come from {', '.join(sorted(origins))})" if origins else ""
    raise UnknownCourse(f'No server is set{several}: call polhode.connect("https://…") first.')


def assignment(given: str | None = None) -> str:
    """Return the assignment's slug: given, connected, or that of the only installed kit. Raises UnknownCourse
    otherwise.
    """
    if found := given or _connected[0].assignment:
        return found
    if len(known := slugs()) == 1:
        return known[0]
    several = f" (kits of {', '.join(known)} are installed)" if known else ""
    raise UnknownCourse(
        f'No assignment is set{several}: call polhode.connect("https://…", assignment="…") first.'
    )


def public(slug: str) -> PublicAssignment:
    """Return the public side of an assignment. Raises UnknownCourse if its kit is not installed, or does not
    fit the installed ``polhode``, which every kit contains and the one installed last replaces.
    """
    install = f"run %pip install --force-reinstall --no-deps {_kit_address(slug)} and restart the kernel"
    if slug not in slugs():
        if not slugs():
            raise UnknownCourse(f"no kit is installed: install the kit of {slug} from your course's server")
        raise UnknownCourse(
            f"the kit of {slug} is not installed, only that of {', '.join(slugs())}: {install}"
        )
    if not _has_checks(slug):
        raise UnknownCourse(f"the kit of {slug} has no local checks: submit your work to have it checked")
    try:
        return _load(slug)
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        raise UnknownCourse(
            f"the kit of {slug} does not fit the installed version of polhode ({reason}): {install}"
        ) from error


def functions(slug: str) -> set[str]:
    """Return the names of the functions that an assignment asks for; empty without its kit or its local
    checks.
    """
    return {f for e in public(slug).exercises for f in e.function_names()} if _has_checks(slug) else set()


def slugs() -> list[str]:
    """Return the slugs of the assignments whose kits are installed."""
    return sorted({path.parent.name.replace("_", "-") for path in FOLDER.glob("*/*.json")})


def build(slug: str) -> str | None:
    """Return the build hash of the assignment's kit, or None if it runs from its source."""
    return _made(slug).get("build")


def _origins(slugs: Iterable[str]) -> set[str]:
    """Return the servers from which the kits of these assignments come."""
    return {made["server"] for slug in slugs if "server" in (made := _made(slug))}


def _kit_address(slug: str) -> str:
    origins = _origins([slug]) or _origins(slugs())
    server, name = min(origins) if origins else "https://…", slug.replace("-", "_")
    return f"{server}/kit/polhode_kit_{name}-{KIT}-py3-none-any.whl"


def _has_checks(slug: str) -> bool:
    return (FOLDER / slug.replace("-", "_") / "public.json").is_file()


def _address(given: str) -> str:
    address = given.strip().rstrip("/")
    if not address.startswith(("http://", "https://")):
        raise UnknownCourse(f"{address} is not a server address: it must begin with http:// or https://")
    return address


def _made(slug: str) -> dict[str, str]:
    path = FOLDER / slug.replace("-", "_") / "made.json"
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
        truth = {
            key.split("/")[1]: array for key, array in arrays.items() if key.startswith(f"{scene['name']}/")
        }
        scenes[scene["name"]] = PublicScene(**scene | {"truth": truth})
    plays: dict[str, Any] = {"__name__": "plays"}
    exec(compile((FOLDER / name / "plays.py").read_bytes(), "plays.py", "exec"), plays)
    found = {
        e["number"]: exercise(e["number"], e["title"], e["questions"], False)
        for e in declared.get("exercises", ())
    }
    own = None
    if (FOLDER / name / "__init__.py").is_file():  # exercises of the author's own
        module = importlib.import_module(f"polhode.assignments.{name}")
        found |= {e.number: e for e in module.EXERCISES}
        own = getattr(module, "diagnose", None)
    exercises = tuple(found[number] for number in declared["hidden"] if number in found)
    return PublicAssignment(slug, declared["version"], declared["hidden"], exercises, scenes, plays, own)
