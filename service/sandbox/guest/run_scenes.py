"""The child's main program: read the job, load the submission, and play each scene within its time budget."""

import ast
import base64
import functools
import linecache
import marshal
import signal
import sys
import types
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from time import monotonic, process_time
from typing import Any, NamedTuple

import numpy as np

from ecp import animate
from ecp.author_errors import SOURCES, AuthorError, author_error, checked_arrays
from ecp.data_files import MODULES, use_modules
from ecp.return_value import describe_exception, is_written, missing

from . import unused_libraries
from .calls import LOADED, Channel
from .claims import PRIVATE as RECORDER
from .claims import Recorder
from .ipython_stubs import install_stubs
from .magics import DEFINITIONS, last_name, needed_sources, pieces, runnable, statements
from .seal import Seal, in_place, names_used, private_modules
from .wire import CLOCK_FACTOR, FILES, Questions, Writer, forget, kept
from .zygote import KINDS_MODULE

Names = dict[str, Any]

DEFINITIONS_S = 1.0  # for the definitions that follow a cell whose time is spent
REPEAT_S = 0.2  # interval of the alarm once a budget may be spent
# the recorder and the integrator: plays import private copies, which a submission cannot replace
INTEGRATION = "ecp.integration"
PRIVATE = ("ecp.artists", "ecp.axes_decoration", "ecp.visibility", "ecp.animation_recording", INTEGRATION)


class OutOfTime(BaseException):
    """The budget of a scene is spent. Not an Exception, so that a broad ``except`` in a submission does not
    swallow it.
    """


class Budget:
    """A budget that starts now: ``seconds`` of CPU time and CLOCK_FACTOR times as many of wall-clock time."""

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self._cpu, self._clock = process_time() + seconds, monotonic() + CLOCK_FACTOR * seconds

    def left(self) -> float:
        """Return the seconds left, of CPU time or of wall-clock time, whichever is less."""
        return max(0.0, min(self._cpu - process_time(), self._clock - monotonic()))

    def sentence(self) -> str:
        """Return a sentence that names the exceeded limit."""
        if process_time() >= self._cpu:
            return f"your code used more than {self.seconds:g} s of CPU time"
        return (
            f"your code did not finish within {CLOCK_FACTOR * self.seconds:g} s (of which it may compute"
            f" {self.seconds:g} s)"
        )


def run(job_fd: int, result_fd: int, calls_fd: int | None = None) -> None:
    """Play the job. Each scene's arrays and scene end are sent before the next scene starts.

    With ``calls_fd`` another process holds functions that stand for those of the submission with the same
    names.
    """
    questions, write = Questions(job_fd), Writer(result_fd)
    job = questions.job()
    forget()
    try:
        plays, unchanged, student = _loaded(job)
        reference = None if calls_fd is None else Reference(calls_fd, job["reference"])
    except BaseException as error:
        write.event("not-prepared", author=author_error(error, lambda filename: False))
        raise
    write.event("prepared")
    with nullcontext() if unused_libraries.lacks("matplotlib") else animate.watched():
        _run(job, plays, student, questions, write, unchanged=unchanged, reference=reference)


def load(setup: str, plays: str) -> None:
    """Load the setup and the plays that this process keeps by these names, before the job that has them
    arrives.
    """
    parts = {"setup": kept(setup), "plays": kept(plays)}
    _in_advance.append((parts, _loaded(parts)))


Loaded = tuple[Names, Callable[[], None], Names]
_in_advance = list[tuple[dict[str, Any], Loaded]]()


def _loaded(job: dict[str, Any]) -> Loaded:
    """Return the names that the job's plays define, a function as ``_load_plays`` returns it, and the
    namespace after its setup.
    """
    if _in_advance:
        parts, loaded = _in_advance.pop()
        if all(part is job[name] for name, part in parts.items()):
            return loaded
    return *_load_plays(job["plays"]["source"], code(job, "plays")), prepare(code(job, "setup"))


def code(job: dict[str, Any], name: str) -> types.CodeType:
    """Return the code of the ``setup`` or the ``plays`` of a job."""
    if text := job[name]["code"]:
        compiled: types.CodeType = marshal.loads(base64.b64decode(text))  # noqa: S302 -- from the host
        return compiled
    return compile(job[name]["source"], FILES[name], "exec")


class Reference:
    """Functions of another process by name, in place of those of the submission. Raises AuthorError if they
    cannot be loaded.
    """

    def __init__(self, calls_fd: int, names: list[str]) -> None:
        self.channel = Channel(calls_fd)
        if error := self.channel.call(LOADED):
            raise AuthorError(error)
        self.functions = {name: self.channel.proxy(name, name) for name in names}


def _run(
    job: dict[str, Any],
    plays: Names,
    student: Names,
    questions: Questions,
    write: Writer,
    *,
    unchanged: Callable[[], None],
    reference: Reference | None,
) -> None:
    recorder = Recorder()
    with recorder.recording():
        shows = _load_submission(student, job, recorder, write, reference.functions if reference else {})
    student |= _adopt(plays, student, shows)
    names = [name for name in job["functions"] if is_written(student.get(name), name in job["variables"])]
    write.event("defined", names=names, claims_left_out=recorder.left_out)
    finished: set[str] = set()
    asked = {scene["name"] for scene in job["scenes"]}
    for scene in job["scenes"]:
        if scene["after"] in asked - finished:
            continue
        if absent := _missing(scene, student, job["variables"]):
            write.event("start", scene=scene["name"])
            write.event(
                "scene",
                scene=scene["name"],
                ended="missing-function",
                code="missing-function",
                sentence=absent,
            )
        elif _play(scene, plays, student, questions, write, unchanged=unchanged):
            finished.add(scene["name"])
        if reference is not None and reference.channel.lost:
            break  # the host plays the scenes that are left in another pair of processes
    write.event("done")


def _missing(scene: dict[str, Any], student: Names, variables: list[str]) -> str | None:
    names = (scene["function"], *scene["needs"]) if scene["source"] is None else ()
    return next((sentence for name in names if (sentence := missing(student, name, name in variables))), None)


def _play(
    scene: dict[str, Any],
    plays: Names,
    student: Names,
    questions: Questions,
    write: Writer,
    *,
    unchanged: Callable[[], None],
) -> bool:
    name = scene["name"]
    write.event("start", scene=name)

    def answer() -> None:
        unchanged()
        names = student
        if scene["source"] is not None:
            names = dict(student)
            exec(compile(scene["source"], "source.py", "exec"), names)
        play = plays[scene["play"]]
        asked = (names,) if scene["question"] is None else (scene["question"], names)
        for inputs in questions if scene["asked"] else [scene["inputs"]]:
            arrays = play(*asked, inputs)
            if not scene["asked"]:
                unchanged()
            write.arrays(checked_arrays(play, arrays, scene["returns"]))

    ended = _run_limited(answer, Budget(scene["budget_s"]))
    write.event("scene", scene=name, **ended)
    return ended["ended"] == "finished"


def copy_modules() -> None:
    """Make the private copies that each play needs, before the zygote starts children."""
    for kinds in {False, KINDS_MODULE in sys.modules}:
        integration: Any = _private(kinds).modules[INTEGRATION]
        integration.tableau()  # before a submission can replace it
        if not unused_libraries.lacks("scipy"):
            integration.solve_ivp()
    with private_modules(RECORDER):
        pass


def rehearse() -> None:
    """Do what each play begins with, without a play, so that the memory it writes to is this process's own
    before the play.
    """
    _, unchanged = _load_plays("", compile("", FILES["plays"], "exec"))
    unchanged()


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


def _load_plays(source: str, code: types.CodeType) -> tuple[Names, Callable[[], None]]:
    """Return the names that plays.py defines, and a function that raises WrongAnswer if a part of them has
    been replaced.

    plays.py gets its own numpy and kit modules.
    """
    private, plays = _private(KINDS_MODULE in source), Names(__name__="plays")
    with in_place(private.modules):
        exec(code, plays)
    plays["np"] = private.numpy
    private.seal.close_names(vars(private.numpy), names_used(code))
    private.seal.close([plays], ["plays"])
    return plays, private.seal.check


def prepare(setup: types.CodeType) -> Names:
    """Return the namespace of a notebook after its setup cell, with the assignment's own modules."""
    use_modules(Path(MODULES).absolute())
    module = types.ModuleType("__main__")
    install_stubs(module.__dict__)
    exec(setup, module.__dict__)
    sys.modules["__main__"] = module
    return module.__dict__


def _adopt(plays: Names, student: Names, shows: str) -> Names:
    """Return functions that plays.py makes from the animation of the cell ``shows``, for those the student
    did not write.
    """
    try:
        made = plays["adopt"](student, shows) if shows and "adopt" in plays else {}
    except Exception:  # treat a notebook that plays.py cannot handle like one without an animation
        made = {}
    return {name: function for name, function in made.items() if not is_written(student.get(name))}


def _load_submission(
    student: Names, job: dict[str, Any], recorder: Recorder, write: Writer, kept: Names
) -> str:
    """Run the cells in order, as a notebook does, and report those that fail. A failure does not stop the
    next cell.

    When their time is spent, the cell that used it up and those after it only define their functions and
    classes. Names in ``kept`` keep their values, whatever the cells assign to them. Return the source of the
    last cell that showed an animation, or an empty string.
    """
    budget, shows, left = Budget(job["load_budget_s"]), "", Budget(DEFINITIONS_S)
    animations = () if unused_libraries.lacks("matplotlib") else sys.modules["matplotlib.animation"].Animation
    student |= kept
    several = any(published for _, _, published in job["cells"])
    needed = _needed_pieces(job) if job["needed_cells"] else None
    for name, source, published in job["cells"]:
        budget = Budget(job["load_budget_s"]) if several else budget
        recorder.cell, recorder.places = name, published
        linecache.cache[name] = (len(source), None, source.splitlines(keepends=True), name)

        for piece in pieces(source):
            if needed is not None and piece not in needed:
                continue
            if budget.left():
                before = animate.shown[:]
                with recorder.in_place(student) if published else nullcontext():
                    ended = _run_limited(functools.partial(_execute, piece, name, student, kept), budget)
                recorder.send(write)
                if (last := student.get(last_name(piece))) is not None and isinstance(last, animations):
                    animate.shown[:] = [last]
                shows = shows if animate.shown == before else piece
                if ended["ended"] != "finished":
                    write.event("cell", scene=name, **ended)
                if budget.left():
                    continue
                left = Budget(DEFINITIONS_S)
            _run_limited(functools.partial(_execute, piece, name, student, kept, DEFINITIONS), left)
    return shows


def _needed_pieces(job: dict[str, Any]) -> set[str]:
    names = {name for scene in job["scenes"] for name in (scene["function"], *scene["needs"])}
    sources = [piece for _, source, _ in job["cells"] for piece in pieces(source)]
    return needed_sources(sources, names) if len(sources) > 1 else set(sources)


def _execute(
    source: str, name: str, student: Names, kept: Names, kinds: tuple[type, ...] = (ast.stmt,)
) -> None:
    """Execute the statements of these ``kinds``. Names in ``kept`` have their values again after each
    statement.
    """
    whole = not kept and kinds == (ast.stmt,)
    for code in [runnable(source, name)] if whole else statements(source, name, kinds):
        exec(code, student)
        student.update(kept)


def _run_limited(action: Callable[[], None], budget: Budget) -> dict[str, Any]:
    """Run ``action`` within ``budget``. Return its scene end as the fields of an event."""

    def check_budget(signum: int, frame: Any) -> None:
        if not budget.left():
            raise OutOfTime

    signal.signal(signal.SIGALRM, check_budget)
    signal.setitimer(signal.ITIMER_REAL, max(0.01, budget.left()), REPEAT_S)
    try:
        try:
            with np.errstate(all="ignore"):
                action()
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
    except OutOfTime:
        return {"ended": "timed-out", "code": "timeout", "sentence": budget.sentence()}
    except BaseException as error:
        return describe_exception(error, _is_of_submission) | {"author": _author_error(error)}
    return {"ended": "finished", "sentence": "finished"}


def _author_error(error: BaseException) -> str | None:
    try:
        return author_error(
            error,
            lambda name: _is_of_submission(name) or (name[:1] == "<" and not name.startswith("<frozen")),
        )
    except BaseException:  # its own __str__ fails, for example
        return None


def _is_of_submission(filename: str) -> bool:
    return filename in linecache.cache and "/" not in filename and filename not in SOURCES
