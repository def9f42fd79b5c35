"""The program of the child that holds reference functions: the right solutions of earlier questions, and the
functions that scenes pass to the submission where these are counted or know a truth. It runs no submission.
"""

import os
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from polhode.judging.return_value import describe_exception

from .cross_process_calls import LOADED, Channel
from .run_scenes import prepare
from .wire import COUNT, JobReader

Function = Callable[..., Any]


def run(job_fd: int, calls_fd: int, counts_fd: int) -> None:
    """Load the right solutions and the functions of scenes, and answer calls of them until the other process
    ends. Each call of a function of a scene is reported to the host.
    """
    job = JobReader(job_fd).job()
    exported: dict[str | int, Function] = {}
    try:
        if job["names"]:
            exported |= _solutions(job)
        error = ""
        for place, one in enumerate(job["apart"]):
            exported[one["target"]] = _counted(_function(one), place, one["unit"], counts_fd)
    except BaseException as raised:
        exported.clear()
        error = f"the right solutions: {describe_exception(raised, lambda file: False)['sentence']}"
    with np.errstate(all="ignore"):
        Channel(calls_fd, exported | {LOADED: lambda: error}, exits=True).serve()


def _solutions(job: Mapping[str, Any]) -> dict[str | int, Function]:
    names = prepare(job["setup"]).__dict__
    exec(compile(job["source"], "solution.py", "exec"), names)
    return {name: names[name] for name in job["names"]}


def _function(of: Mapping[str, Any]) -> Function:
    from polhode.kinds.student_calls import expression  # a zygote may have imported it later

    given = {
        name: np.array(value) if isinstance(value, list) else value for name, value in of["given"].items()
    }
    return expression(of["text"], tuple(of["over"]), given)


def _counted(function: Function, place: int, unit: int, counts_fd: int) -> Function:
    from polhode.kinds.student_calls import evaluations

    def counted(*values: Any, **named: Any) -> Any:
        os.write(counts_fd, COUNT.pack(place, evaluations([*values, *named.values()], unit)))
        return function(*values, **named)

    return counted
