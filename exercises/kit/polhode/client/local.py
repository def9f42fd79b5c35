"""``polhode.check``: runs the public scenes in the notebook's own kernel and judges them as the server
does.
"""

import functools
import inspect
import os
import platform
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from polhode.animation import animate
from polhode.client import cache, course
from polhode.client.course import UnknownCourse
from polhode.client.public_assignment import PublicAssignment, PublicScene, public
from polhode.judging.author_errors import (
    LIBRARIES,
    SOURCES,
    UNUSABLE,
    AuthorError,
    author_error,
    checked_arrays,
)
from polhode.judging.checks import Arrays, Check
from polhode.judging.exercise import Exercise, attempted, points
from polhode.judging.outcome import Diagnosis, Ended, ExerciseReport, Outcome, SceneEnd
from polhode.judging.remarks import Absent, Notes, noting, unsaid
from polhode.judging.return_value import describe_exception, is_written, missing
from polhode.judging.time_limit import OutOfTime, limited
from polhode.judging.verdict import Verdict
from polhode.report.failure_causes import suspect_lines
from polhode.report.report import Provenance, Report, pictures

KIT, STANDARD_LIBRARY = Path(__file__).parent, Path(os.__file__).parent
ISOLATION = "none: checked in your own kernel"


def check(*numbers: str | int, assignment: str | None = None) -> Report:
    """Run the public checks of the exercises ``numbers``, offline, and return the report with the server's
    own lines.

    The default is every exercise with a function that is no longer empty. Functions are found by name in the
    module that calls ``check``. Raises UnknownCourse for an assignment the kit does not contain or an
    exercise the assignment does not have, and AuthorError if the assignment's own code fails.
    """
    names = sys._getframe(1).f_globals
    known = public(course.assignment(assignment))
    asked, variables = {f for e in known.exercises for f in e.function_names()}, known.variables()
    written = {name for name in asked if is_written(names.get(name), name in variables)}
    chosen = _chosen(known, [str(number) for number in numbers], written)
    checks = {e.number: e.applicable_checks(written, known.names) for e in chosen}
    try:
        with _close_new_figures(), animate.watched():
            played = _play(_needed(chosen, checks, known), known, names)
        sections = []
        for e in chosen:
            said = set[str]()
            outcomes = [_outcome(c, known, played, said) for c in checks[e.number]]
            sections.append(ExerciseReport(e.number, e.title, outcomes))
    except AuthorError as error:
        raise AuthorError(
            f"The assignment {known.slug} has an error, not your code: {error}. Report it to the course"
            " staff."
        ) from error
    versions = {"python": platform.python_version()} | {
        name: metadata.version(name) for name in ("numpy", "scipy")
    }
    missed = [] if numbers else [e for e in known.exercises if e not in chosen]
    total = points([*chosen, *missed], known.exercises, written, known.names)
    made = Provenance(0, versions, ISOLATION)
    report = Report(known.slug, known.version, sections, made, total, local=True)
    functions = {
        c.id: known.scenes[c.scenes[0]].function for listed in checks.values() for c in listed if c.scenes
    }
    report.suspect_lines = suspect_lines(sections, functions.__getitem__, lambda name: _cells(names, name))
    report.not_attempted = [e.number for e in missed]
    report.weighted = any(c.points > 1 for e in known.exercises for c in e.checks)
    report.scene_ends = [
        scene_end for scene_end in played.scene_ends.values() if scene_end.ended is not Ended.FINISHED
    ]
    arrays = played.arrays
    report.figures, report.animations = pictures(chosen, arrays)
    report.drawn = functools.cache(lambda name: _draw(chosen, known, arrays, name))
    more = sum(known.hidden.get(e.number, 0) for e in chosen)
    remark = (
        f"Checked locally. The server makes {more} more checks, with new random inputs for each submission."
    )
    report.remark = remark if more else ""
    report.remark += "".join(f" {slow}" for slow in played.slow)
    return report


@dataclass
class SceneRun:
    """What the scenes returned, their notes, how they ended, and remarks on those slower than the server
    allows.
    """

    arrays: dict[str, dict[str, Any]] = field(default_factory=dict)
    notes: dict[str, Notes] = field(default_factory=dict)
    scene_ends: dict[str, SceneEnd] = field(default_factory=dict)
    slow: list[str] = field(default_factory=list)


def _chosen(known: PublicAssignment, numbers: list[str], written: set[str]) -> list[Exercise]:
    declared = {e.number: e for e in known.exercises}
    if unknown := [number for number in numbers if number not in declared]:
        raise UnknownCourse(
            f"{known.slug} has no exercise {', '.join(unknown)}; it has {', '.join(declared)}"
        )
    return [e for e in known.exercises if e.number in numbers] or attempted(known.exercises, written)


def _needed(
    chosen: list[Exercise], checks: Mapping[str, list[Check]], known: PublicAssignment
) -> list[PublicScene]:
    """Return the scenes of the checks and figures, each behind the one it comes after."""
    wanted = [s for listed in checks.values() for c in listed for s in c.scenes]
    wanted += [s for e in chosen for f in e.figures for s in f.scenes]
    ordered = [name for s in wanted for name in (known.scenes[s].after, s) if name is not None]
    return [known.scenes[name] for name in dict.fromkeys(ordered)]


def _play(scenes: list[PublicScene], known: PublicAssignment, names: Mapping[str, Any]) -> SceneRun:
    played, variables = SceneRun(), known.variables()
    for scene in scenes:
        before = played.scene_ends.get(scene.after or "")
        if before is not None and before.ended is not Ended.FINISHED:
            played.scene_ends[scene.name] = SceneEnd(scene.name, Ended.NOT_PLAYED, before.sentence)
            continue
        absent = {
            name: Absent(sentence, "missing-function")
            for name in (scene.function, *scene.needs)
            if (sentence := missing(names, name, name in variables))
        }
        some = len(absent) <= len(scene.needs) and (scene.question or {}).get("variables")
        if absent and not some:
            sentence, code = next(iter(absent.values()))
            played.scene_ends[scene.name] = SceneEnd(scene.name, Ended.MISSING, sentence, code)
        else:
            _play_one(scene, known, names, played)
    return played


def _play_one(
    scene: PublicScene, known: PublicAssignment, names: Mapping[str, Any], played: SceneRun
) -> None:
    began = time.monotonic()
    try:
        with np.errstate(all="ignore"), limited(scene.budget_s), noting() as notes:
            seen = _call(scene, known, names)
    except KeyboardInterrupt:
        raise
    except OutOfTime:
        sentence = f"your code did not finish within {scene.budget_s:g} s"
        played.scene_ends[scene.name] = SceneEnd(scene.name, Ended.TIMED_OUT, sentence, "timeout")
        return
    except BaseException as error:
        described = describe_exception(error, _own)
        ended, sentence = Ended(str(described["ended"])), " ".join(str(described["sentence"]).split())
        if found := author_error(error, _own):
            if isinstance(error, NameError) or _fails_anyway(found, scene, known, names):
                raise AuthorError(f"scene {scene.name}: {found}") from error
            ended, sentence = Ended.WRONG_ANSWER, UNUSABLE.format(function=scene.function, error=sentence)
            described["code"] = None
        played.scene_ends[scene.name] = SceneEnd(
            scene.name, ended, sentence, described["code"], described.get("traceback")
        )
        return
    if (took := time.monotonic() - began) > scene.budget_s:
        played.slow.append(
            f"Scene {scene.name} took {took:.0f} s here; the server allows {scene.budget_s:g} s."
        )
    played.arrays[scene.name] = {name: np.array(array) for name, array in seen.items()} | {
        k: scene.truth[k] for k in scene.known
    }
    played.notes[scene.name] = notes
    played.scene_ends[scene.name] = SceneEnd(scene.name, Ended.FINISHED, "finished")


def _call(scene: PublicScene, known: PublicAssignment, names: Mapping[str, Any]) -> dict[str, Any]:
    play, question = known.plays[scene.play], () if scene.question is None else (scene.question,)
    seen: dict[str, Any] = play(*question, names, scene.inputs)
    return seen if scene.returns is None else checked_arrays(play, seen, scene.returns)


def _fails_anyway(found: str, scene: PublicScene, known: PublicAssignment, names: Mapping[str, Any]) -> bool:
    """Return whether a scene fails in the same way for a function that returns an object without any
    properties.
    """
    try:
        with np.errstate(all="ignore"), limited(scene.budget_s):
            _call(scene, known, {**names, scene.function: lambda *values, **named: object()})
    except Exception as error:
        return author_error(error, _own) == found
    return False


@contextmanager
def _close_new_figures() -> Iterator[None]:
    """Close the figures that the student's code opens: the report shows its own."""
    pyplot = sys.modules.get("matplotlib.pyplot")
    before = set(pyplot.get_fignums()) if pyplot else set()
    try:
        yield
    finally:
        if pyplot := sys.modules.get("matplotlib.pyplot"):
            for number in set(pyplot.get_fignums()) - before:
                pyplot.close(number)


def _outcome(check: Check, known: PublicAssignment, played: SceneRun, said: set[str]) -> Outcome:
    notes = [played.notes[name] for name in check.scenes if name in played.notes]
    absent = next(filter(None, (one.unread(check.arrays) for one in notes)), None)
    if missing := next((name for name in check.scenes if name not in played.arrays), None):
        outcome = check.unmeasured(played.scene_ends[missing].sentence)
    elif absent:
        outcome = check.unmeasured(absent.sentence)
    else:
        truths = [known.scenes[name].truth for name in check.scenes]
        outcome = check.judge([played.arrays[name] for name in check.scenes], truths)
    if outcome.verdict is not Verdict.PASS:
        outcome.diagnosis = _likely(check, known, played)
        if absent:
            outcome.diagnosis = [Diagnosis(absent.code, absent.sentence, 1.0)] if absent.code else []
        is_missing = played.scene_ends[check.scenes[0]].ended is Ended.MISSING
        uses = () if is_missing else (known.scenes[check.scenes[0]].question or {}).get("uses", ())
        outcome.remarks = [
            f"checked with your own {name}: where that is wrong or missing, the server uses the reference"
            for name in uses
        ]
    outcome.remarks += unsaid(notes, said)
    return outcome


def _likely(check: Check, known: PublicAssignment, played: SceneRun) -> list[Diagnosis]:
    """Return the causes that the numbers of a scene, or of the one before it, single out; else how the code
    ended.
    """
    names = [
        name for scene in check.scenes for name in (known.scenes[scene].after, scene) if name is not None
    ]
    for name in names:
        if name in played.arrays and (found := _diagnosed(known, name, played.arrays[name])):
            return found
    scene_ends = [played.scene_ends[name] for name in names if name in played.scene_ends]
    return [
        Diagnosis(scene_end.code, scene_end.sentence, 1.0)
        for scene_end in scene_ends
        if scene_end.code is not None
    ][:1]


def _diagnosed(known: PublicAssignment, name: str, arrays: Arrays) -> list[Diagnosis]:
    """Return the likely causes; none if the diagnosis itself fails,
    because a report must not depend on it.
    """
    try:
        with np.errstate(all="ignore"):
            return known.diagnose(name, arrays)
    except Exception:
        return []


def _cells(names: Mapping[str, Any], function: str) -> list[tuple[str, str]]:
    """Return the source of a function, with its line numbers, as a cell without a name, if it has one."""
    try:
        lines, first = inspect.getsourcelines(names[function])
    except (OSError, TypeError, KeyError):
        return []
    return [("", "\n" * (first - 1) + "".join(lines))]


def _draw(
    chosen: list[Exercise], known: PublicAssignment, arrays: Mapping[str, Arrays], name: str
) -> bytes | None:
    from polhode.report.figure_files import contact_sheet, draw

    for figure in (f for e in chosen for f in e.figures if f.name == name):
        return draw(
            figure, [arrays[s] for s in figure.scenes], [known.scenes[s].truth for s in figure.scenes]
        )
    for animation in (a for e in chosen for a in e.animations if a.name == name):
        return contact_sheet(arrays[animation.scene][animation.array])
    return None


def _own(filename: str) -> bool:
    """Return whether a frame of a traceback is the student's code, not the kit's or a library's."""
    path = Path(filename)
    return not (
        filename in SOURCES
        or {KIT, STANDARD_LIBRARY, cache.folder()} & set(path.parents)
        or LIBRARIES & set(path.parts)
    )
