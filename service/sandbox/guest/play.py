"""In the child: read the job, load the submission, play its scenes one by one, each with its own time budget."""

import linecache
import signal
import sys
import time
import types
from collections.abc import Callable
from typing import Any

import numpy as np

from ecp.stopped import stopped
from ecp.strict import is_written, real_array

from .cells import pieces, runnable
from .claims import Recorder
from .notebook import settle, stand_ins
from .wire import Questions, Writer

Names = dict[str, Any]


class OutOfTime(BaseException):
    """The budget of a scene is spent. Not an Exception, so that a broad ``except`` in a submission does not swallow it."""


def run(job_fd: int, result_fd: int) -> None:
    """Play the whole job; every scene's arrays and ending leave before the next one starts."""
    questions, write = Questions(job_fd), Writer(result_fd)
    job = questions.job()
    plays, student = _load_plays(job["plays"]), _prepare(job["setup"])
    write.event("inside")
    recorder = Recorder()
    with recorder.recording():
        _load_submission(student, job, recorder, write)
    names = [name for name in job["functions"] if is_written(student.get(name))]
    write.event("defined", names=names, claims_left_out=recorder.left_out)
    finished: set[str] = set()
    asked = {scene["name"] for scene in job["scenes"]}
    for scene in job["scenes"]:
        if scene["after"] in asked - finished:
            write.event("scene", scene=scene["name"], ending="not-played", sentence=f"it comes after {scene['after']}")
        elif _play(scene, plays, student, questions, write):
            finished.add(scene["name"])
    write.event("done")


def _play(scene: dict[str, Any], plays: Names, student: Names, questions: Questions, write: Writer) -> bool:
    name = scene["name"]
    write.event("start", scene=name)
    if not callable(student.get(scene["function"])):
        sentence = f"{scene['function']} is not defined"
        write.event("scene", scene=name, ending="missing-function", code="missing-function", sentence=sentence)
        return False

    def answer() -> None:
        function = student[scene["function"]]
        if scene["asked"]:
            for t, w, moments in questions:
                write.answer(real_array(function(t, w, moments), (3,), scene["function"]))
            return
        for key, array in plays[scene["play"]](student, scene["inputs"]).items():
            write.array(name, key, array)

    ended = _attempt(answer, scene["budget_s"])
    write.event("scene", scene=name, **ended)
    return ended["ending"] == "finished"


def _load_plays(source: str) -> Names:
    plays: Names = {"__name__": "plays"}
    exec(compile(source, "plays.py", "exec"), plays)
    return plays


def _prepare(setup: str) -> Names:
    """The namespace of a notebook after its setup cell."""
    module = types.ModuleType("__main__")
    sys.modules |= stand_ins()
    exec(compile(setup, "setup.py", "exec"), module.__dict__)
    settle(module.__dict__)
    sys.modules["__main__"] = module
    return module.__dict__


def _load_submission(student: Names, job: dict[str, Any], recorder: Recorder, write: Writer) -> None:
    """Run the cells one after the other, as a notebook does; a cell that fails is told and the next one goes on."""
    deadline = time.monotonic() + job["load_budget_s"]
    for name, source in job["cells"]:
        recorder.cell = name
        linecache.cache[name] = (len(source), None, source.splitlines(keepends=True), name)

        for piece in pieces(source):

            def load(name: str = name, piece: str = piece) -> None:
                exec(runnable(piece, name), student)

            ended = _attempt(load, max(0.01, deadline - time.monotonic()))
            recorder.send(write)
            if ended["ending"] != "finished":
                write.event("cell", scene=name, **ended)
            if time.monotonic() > deadline:
                return


def _attempt(action: Callable[[], None], budget_s: float) -> dict[str, Any]:
    """Run it under an alarm; how it ended, as the fields of an event."""

    def ring(signum: int, frame: Any) -> None:
        raise OutOfTime

    signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, budget_s, 0.2)
    try:
        try:
            with np.errstate(all="ignore"):
                action()
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
    except OutOfTime:
        return {"ending": "timed-out", "code": "timeout", "sentence": f"your code did not finish within {budget_s:g} s"}
    except BaseException as error:
        return stopped(error, _own)
    return {"ending": "finished", "sentence": "finished"}


def _own(filename: str) -> bool:
    return filename in linecache.cache and "/" not in filename and filename not in ("plays.py", "setup.py")
