"""In the child: read the job, load the submission, play its scenes one by one, each with its own time budget."""

import linecache
import signal
import sys
import time
import traceback
import types
from collections.abc import Callable
from typing import Any

import numpy as np

from ecp.strict import WrongAnswer, real_array

from .cells import runnable
from .notebook import stand_ins
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
    _load_submission(student, job, write)
    write.event("defined", names=[name for name in job["functions"] if callable(student.get(name))])
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
    sys.modules["__main__"] = module
    return module.__dict__


def _load_submission(student: Names, job: dict[str, Any], write: Writer) -> None:
    """Run the cells one after the other, as a notebook does; a cell that fails is told and the next one goes on."""
    deadline = time.monotonic() + job["load_budget_s"]
    for name, source in job["cells"]:
        linecache.cache[name] = (len(source), None, source.splitlines(keepends=True), name)

        def load(name: str = name, source: str = source) -> None:
            exec(runnable(source, name), student)

        ended = _attempt(load, max(0.01, deadline - time.monotonic()))
        if ended["ending"] != "finished":
            write.event("cell", scene=name, **ended)
        if time.monotonic() > deadline:
            break


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
    except WrongAnswer as wrong:
        return {"ending": "wrong-answer", "code": wrong.code, "sentence": str(wrong)}
    except MemoryError as error:
        return {
            "ending": "memory",
            "code": "memory",
            "sentence": "your code asked for more memory than is allowed",
            **_trace(error),
        }
    except SyntaxError as error:
        return {"ending": "syntax-error", "code": "syntax-error", "sentence": _said(error), **_trace(error)}
    except BaseException as error:
        return {"ending": "raised", "code": "raises", "sentence": _said(error), **_trace(error)}
    return {"ending": "finished", "sentence": "finished"}


def _said(error: BaseException) -> str:
    try:
        return f"{type(error).__name__}: {error}"[:500]
    except BaseException:
        return type(error).__name__[:500]


def _trace(error: BaseException) -> dict[str, str]:
    """The student's own lines of the traceback: frames of the harness and of the libraries are left out."""
    try:
        frames = [f for f in traceback.extract_tb(error.__traceback__) if f.filename in linecache.cache and "/" not in f.filename]
        own = [f for f in frames if f.filename not in ("plays.py", "setup.py")]
        last = traceback.format_exception_only(error)
        return {"traceback": "".join(traceback.format_list(own[-8:]) + last)[:6000]}
    except BaseException:
        return {}
