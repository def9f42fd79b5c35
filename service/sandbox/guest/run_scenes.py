"""The child's main program: read the job, load the submission, and play each scene within its time budget."""

import functools
import sys
import types
from collections.abc import Callable, Mapping
from contextlib import nullcontext
from typing import Any, NamedTuple

import numpy as np

import polhode
from polhode.animation import animate
from polhode.judging.author_errors import AuthorError, author_error, checked_arrays
from polhode.judging.remarks import Absent, noting
from polhode.judging.return_value import is_written, missing

from . import deferred_libraries
from .cells.claim_recorder import Recorder
from .cells.run_cells import Cells, Stopped
from .cross_process_calls import LOADED, Channel
from .ending import Cause, ending
from .null_object import NOTHING
from .return_structure import in_form_of
from .tamper_detection import Seal, in_place, names_used, private_modules
from .time_budget import Budget, limited
from .wire import APART, FILES, JobReader, Writer
from .zygote import KINDS_MODULE

Names = dict[str, Any]

# Functions of the kit that do nothing here: a notebook that checks and submits itself must not do so while it
# is graded.
NOTEBOOK_ONLY = ("check", "connect", "login", "logout", "submissions", "submit")
# the recorder and the integrator: plays import private copies, which a submission cannot replace
INTEGRATION = "polhode.judging.integration"
PRIVATE = (
    "polhode.animation.artist_points",
    "polhode.animation.draw_decoration_once",
    "polhode.animation.visible_changes",
    "polhode.animation.animation_recording",
    INTEGRATION,
)


def run(job_fd: int, result_fd: int, calls_fd: int | None = None) -> None:
    """Play the job. Each scene's arrays and scene end are sent before the next scene starts.

    With ``calls_fd`` another process holds functions that stand for those of the submission with the same
    names.
    """
    job, write = JobReader(job_fd).job(), Writer(result_fd)
    try:
        plays, unchanged = _load_plays(job["plays"])
        recorder = Recorder(write)
        recorder.wrap([job["setup"], *(source for _, source, _ in job["cells"])])
        module = prepare(job["setup"])
        reference = None if calls_fd is None else Reference(calls_fd, job["reference"], formed=job["formed"])
    except BaseException as error:
        write.event("not-prepared", author=author_error(error, lambda filename: False))
        raise
    write.event("prepared")
    with nullcontext() if deferred_libraries.lacks("matplotlib") else animate.watched():
        _run(job, plays, module, write, recorder, unchanged=unchanged, reference=reference)


class Reference:
    """Functions of another process by name, in place of those of the submission, which are kept in
    ``replaced``. With ``formed`` they return values in the form of those. Raises AuthorError if they
    cannot be loaded.
    """

    def __init__(self, calls_fd: int, names: list[str], *, formed: bool) -> None:
        self.channel = Channel(calls_fd)
        if error := self.channel.call(LOADED):
            raise AuthorError(error)
        self.functions = {name: self.channel.proxy(name, name) for name in names}
        self.replaced: Names = {}
        if formed:
            self.functions = {
                name: in_form_of(self.replaced, name, function) for name, function in self.functions.items()
            }

    def inputs(self, scene: dict[str, Any]) -> dict[str, Any]:
        """Return the inputs of a scene with the functions that are not made in this process, one a row."""
        names, rows = scene["apart"]
        made = {
            name: [
                self.channel.proxy(APART.format(scene=scene["name"], name=name, row=row), name)
                for row in range(rows)
            ]
            for name in names
        }
        return scene["inputs"] | made


def _run(
    job: dict[str, Any],
    plays: Names,
    module: types.ModuleType,
    write: Writer,
    recorder: Recorder,
    *,
    unchanged: Callable[[], None],
    reference: Reference | None,
) -> None:
    student = module.__dict__
    fixed = (reference.functions, reference.replaced) if reference else ({}, {})
    cells = Cells(job, module, write, *fixed)
    try:
        with recorder.recording():
            cells.run(recorder)
    except Stopped:
        return
    questions = [scene["question"] for scene in job["scenes"]]
    student |= _adopt(plays, questions, student | cells.names_shown, cells.shows)
    names = [name for name in job["functions"] if is_written(student.get(name), name in job["variables"])]
    missing = cells.missing(job["functions"])
    write.event("defined", names=names, missing=missing, claims_left_out=recorder.left_out, costs=cells.costs)
    finished: set[str] = set()
    asked = {scene["name"] for scene in job["scenes"]}
    for scene in job["scenes"]:
        if scene["after"] in asked - finished:
            continue
        if reference is not None and scene["apart"]:
            scene["inputs"] = reference.inputs(scene)
        absent = _missing(scene, student, job["variables"], cells.statements.causes)
        if absent and not _answers_without(scene, absent):
            name, (sentence, code) = next(iter(absent.items()))
            because = cells.statements.causes[name]._asdict() if name in cells.statements.causes else {}
            because |= {"because": because.pop("sentence")} if because else {}
            write.event("start", scene=scene["name"])
            fields = because | {"sentence": sentence, "code": code}
            write.event("scene", scene=scene["name"], ended="missing-function", **fields)
        elif _answer_scene(
            scene,
            plays,
            student,
            write,
            unchanged=unchanged,
            cause=cells.statements.cause,
            absent=absent,
        ):
            finished.add(scene["name"])
        if reference is not None and reference.channel.lost:
            break  # the host plays the scenes that are left in another pair of processes
    write.event("done")


def _missing(
    scene: dict[str, Any], student: Names, variables: list[str], causes: Mapping[str, Cause]
) -> dict[str, Absent]:
    """Return the missing names that the scene needs, with a sentence and a diagnosis code."""
    found = dict[str, Absent]()
    for name in (scene["function"], *scene["needs"]) if scene["source"] is None else ():
        if sentence := missing(student, name, name in variables):
            if (cause := causes.get(name)) is None:
                found[name] = Absent(sentence, "missing-function")
            else:
                found[name] = Absent(f"{sentence} because {cause.sentence}", cause.code)
    return found


def _answers_without(scene: dict[str, Any], absent: Mapping[str, Absent]) -> bool:
    """Return whether a scene is about variables, of which some are not absent."""
    return bool((scene["question"] or {}).get("variables")) and len(absent) <= len(scene["needs"])


def _answer_scene(
    scene: dict[str, Any],
    plays: Names,
    student: Names,
    write: Writer,
    *,
    unchanged: Callable[[], None],
    cause: Callable[[BaseException], Cause | None],
    absent: Mapping[str, Absent],
) -> bool:
    name = scene["name"]
    write.event("start", scene=name)

    is_submission = scene["source"] is None

    def answer() -> None:
        names = student
        if is_submission:
            unchanged()
        else:
            names = dict(student)
            exec(compile(scene["source"], "source.py", "exec"), names)
        play = plays[scene["play"]]
        asked = (names,) if scene["question"] is None else (scene["question"], names)
        arrays = play(*asked, scene["inputs"])
        if is_submission:
            unchanged()
        write.arrays(checked_arrays(play, arrays, scene["returns"]))

    budget = Budget(scene["budget_s"])
    with noting() as notes:
        notes.absent |= absent
        error = limited(answer, budget)
    ended = ending(error, budget, None if error is None else cause(error))
    if error is None:
        ended |= {"remarks": notes.remarks, "absent": notes.absent}
    write.event("scene", scene=name, **ended)
    return ended["ended"] == "finished"


def copy_modules() -> None:
    """Make the private copies that each play needs, before the zygote starts children."""
    for kinds in {False, KINDS_MODULE in sys.modules}:
        integration: Any = _private(kinds).modules[INTEGRATION]
        integration.tableau()  # before a submission can replace it
        if not deferred_libraries.lacks("scipy"):
            integration.solve_ivp()


class _Private(NamedTuple):
    """Copies of the modules that plays use, and of numpy, which a submission cannot replace by their names,
    and their seal.
    """

    modules: dict[str, types.ModuleType]
    numpy: types.ModuleType
    seal: Seal


@functools.cache
def _private(kinds: bool) -> _Private:
    """Make copies for plays, which may use the modules of KINDS_MODULE. The zygote does so for its children.

    The recorder gets the seal's check by the name ``unchanged``.
    """
    names = (
        *PRIVATE,
        *(sorted(name for name in sys.modules if name.startswith(KINDS_MODULE)) if kinds else ()),
    )
    own, seal = types.ModuleType("numpy"), Seal()
    own.__dict__.update(vars(np))
    with private_modules(names) as modules:
        spaces = [vars(module) for module in modules.values()]
    for space in spaces:
        space["np"] = own
        if "unchanged" in space:
            space["unchanged"] = seal.check
        seal.close_names(vars(own), names_used(space["__loader__"].get_code(space["__name__"])))
    seal.close(spaces, names)
    return _Private(modules, own, seal)


def _load_plays(source: str) -> tuple[Names, Callable[[], None]]:
    """Return the names that plays.py defines, and a function that raises WrongAnswer if a part of them has
    been replaced.

    plays.py gets its own numpy and kit modules.
    """
    code = compile(source, FILES["plays"], "exec")
    private, plays = _private(KINDS_MODULE in source), Names(__name__="plays")
    with in_place(private.modules):
        exec(code, plays)
    plays["np"] = private.numpy
    private.seal.close_names(vars(private.numpy), names_used(code))
    private.seal.close([plays], ["plays"])
    return plays, private.seal.check


def prepare(setup: str) -> types.ModuleType:
    """Return the main module of a notebook after its Setup cell.

    What belongs to a screen or a server does nothing in it.
    """
    for name in NOTEBOOK_ONLY:
        setattr(polhode, name, NOTHING)
    module = types.ModuleType("__main__")
    module.__dict__.update(display=NOTHING, get_ipython=NOTHING)
    exec(compile(setup, FILES["setup"], "exec"), module.__dict__)
    sys.modules["__main__"] = module
    return module


def _adopt(plays: Names, questions: list[Any], student: Names, shows: str) -> Names:
    """Return functions made from the animation of the cell ``shows``, for those the student did not write."""
    try:
        made = plays["adopt"](questions, student, shows) if shows and "adopt" in plays else {}
    except Exception:  # treat a notebook that cannot be handled like one without an animation
        made = {}
    return {name: function for name, function in made.items() if not is_written(student.get(name))}
