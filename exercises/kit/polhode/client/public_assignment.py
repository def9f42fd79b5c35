"""The public side of an assignment, which ``polhode.check`` plays and judges."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from polhode.client.cache import home, made, slugs
from polhode.client.course import UnknownCourse
from polhode.client.kit_hash import WHEEL
from polhode.judging.checks import Arrays
from polhode.judging.exercise import Exercise
from polhode.judging.outcome import Diagnosis
from polhode.kinds import diagnose, exercise
from polhode.kinds.values import compared


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

    def names(self, scene: str) -> set[str]:
        """Return the notebook's names that a scene, and those it comes after, cannot be played without."""
        found = self.scenes[scene]
        return {found.function, *found.needs} | (
            self.names(found.after) if found.after is not None else set()
        )

    def diagnose(self, scene: str, seen: Arrays) -> list[Diagnosis]:
        """Return the likely causes behind what a scene returned."""
        found = self.scenes[scene]
        if found.question is None:
            return []
        known = diagnose(found.question, seen, found.truth)
        return compared(found.question, seen, found.truth) if known is None else known

    def variables(self) -> set[str]:
        """Return the names that stand for a value, not for a function."""
        return {name for e in self.exercises for name in e.variables}


def public(slug: str) -> PublicAssignment:
    """Return the public side of an assignment. Raises UnknownCourse if it is not in the cache, or does not
    fit the installed kit.
    """
    about = made(slug)
    if not about:
        known = f" (only {', '.join(slugs())})" if slugs() else ""
        raise UnknownCourse(
            f"the checks of {slug} are not on this computer{known}: call"
            f' polhode.connect("https://…", assignment="{slug}") with the address of your course\'s server'
        )
    if not _has_checks(slug):
        raise UnknownCourse(f"{slug} has no local checks: submit your work to have it checked")
    try:
        return _load(home(slug), slug, about["build"])
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        raise UnknownCourse(
            f"the checks of {slug} do not fit the installed version of polhode-kit ({reason}): run %pip"
            f" install --force-reinstall --no-deps {about['server']}/kit/{WHEEL} and restart the kernel"
        ) from error


def functions(slug: str) -> set[str]:
    """Return the names of the functions that an assignment asks for; empty without its local checks."""
    return {f for e in public(slug).exercises for f in e.function_names()} if _has_checks(slug) else set()


def _has_checks(slug: str) -> bool:
    return (home(slug) / "public.json").is_file()


@cache
def _load(folder: Path, slug: str, build: str) -> PublicAssignment:
    declared = json.loads((folder / "public.json").read_bytes())
    with np.load(folder / "truth.npz", allow_pickle=False) as archive:
        arrays = {key: archive[key] for key in archive.files}
    scenes = {}
    for scene in declared["scenes"]:
        truth = {
            key.split("/")[1]: array for key, array in arrays.items() if key.startswith(f"{scene['name']}/")
        }
        scenes[scene["name"]] = PublicScene(**scene | {"truth": truth})
    plays: dict[str, Any] = {"__name__": "plays"}
    exec(compile((folder / "plays.py").read_bytes(), "plays.py", "exec"), plays)
    found = {
        e["number"]: exercise(e["number"], e["title"], e["questions"], False)
        for e in declared.get("exercises", ())
    }
    exercises = tuple(found[number] for number in declared["hidden"] if number in found)
    return PublicAssignment(slug, declared["version"], declared["hidden"], exercises, scenes, plays)
