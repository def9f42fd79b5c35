"""Grading files in several processes, with one sandbox each."""

import multiprocessing
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing.sharedctypes import Synchronized

from service.grading.grade_file import GradeOptions, GradeRequest, grade_file, start_grader
from service.grading.graded_file import GradedFile
from service.grading.grader import Grader
from service.sandbox.guest.confinement.lockdown import die_with_parent
from service.sandbox.sandbox import Sandbox


def grade_in_processes(
    requests: Sequence[GradeRequest],
    options: GradeOptions,
    sandbox: Sandbox,
    processes: int,
    on_progress: Callable[[int], None],
) -> Iterator[GradedFile]:
    """Grade files in ``processes`` and yield one result per file, in input order. Each process has a sandbox
    of its own: the first has this one, which is closed at the end as the others are.

    A lost process is a system fault of every file that is not graded yet.
    """
    others, started = set(multiprocessing.active_children()), multiprocessing.Value("i", 0)
    more = (Sandbox(sandbox.isolation, sandbox.limits) for _ in range(processes - 1))
    sandboxes = [sandbox, *more]
    for one in sandboxes:
        one.start()  # here: their guests then outlive a lost process, and are ended here
    fork = multiprocessing.get_context("fork")
    pool = ProcessPoolExecutor(processes, fork, _initialize, (options, sandboxes, started))
    try:
        futures = [pool.submit(_grade, request) for request in requests]
        yield from _in_order(requests, futures, on_progress)
    finally:
        for child in set(multiprocessing.active_children()) - others:
            child.kill()  # it is idle or its work was cancelled; its guest ends with it
        pool.shutdown(cancel_futures=True)
        for one in sandboxes:
            one.close()


def _in_order(
    requests: Sequence[GradeRequest],
    futures: Sequence["Future[GradedFile]"],
    on_progress: Callable[[int], None],
) -> Iterator[GradedFile]:
    done: list[object] = []

    def count(future: object) -> None:
        done.append(future)
        on_progress(len(done))

    for future in futures:
        future.add_done_callback(count)
    for request, future in zip(requests, futures, strict=True):
        try:
            yield future.result()
        except BrokenProcessPool:
            yield GradedFile(file=request.file, fault="a grading process was lost (killed, or out of memory)")


_process: tuple[Grader, GradeOptions] | None = None


def _initialize(options: GradeOptions, sandboxes: Sequence[Sandbox], started: "Synchronized[int]") -> None:
    """Start with one of the ``sandboxes``: that whose number is the number of processes that have ``started``
    before.
    """
    global _process  # noqa: PLW0603 -- a pool's initializer can pass its result in no other way
    die_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is handled by the parent process
    with started.get_lock():
        own, started.value = sandboxes[started.value], started.value + 1
    _process = start_grader(own), options


def _grade(request: GradeRequest) -> GradedFile:
    assert _process is not None
    return grade_file(*_process, request)
