"""Grade files without a server, in this process or in several."""

import os
from collections.abc import Callable, Iterator, Sequence

from service.grading.grade import missing_packages, select
from service.grading.grade_file import GradeOptions, GradeRequest, grade_file, start_grader
from service.grading.graded_file import GradedFile
from service.grading.parallel import grade_in_processes
from service.sandbox.isolation.levels import Isolation
from service.sandbox.isolation.select import with_packages
from service.sandbox.result import SystemFault
from service.sandbox.sandbox import Sandbox


def grade_files(
    requests: Sequence[GradeRequest],
    options: GradeOptions,
    sandbox: Sandbox | Isolation,
    jobs: int | None = None,
    on_progress: Callable[[int], None] = lambda done: None,
) -> Iterator[GradedFile]:
    """Grade files in parallel and yield one result per file, in input order. Close the ``sandbox``, which may
    have started.

    Uses one process per CPU, at most ``jobs``, each with a sandbox of its own. Calls ``on_progress`` with the
    number of files done. Before grading, raises UnknownExercise, OSError if a file cannot be read, and
    SystemFault if a package of the assignment is not installed or the sandbox fails. Later failures are
    system faults of single files; a lost process affects all files not yet graded.
    """
    for request in requests:
        select(options.assignment, request.exercises)
    if absent := missing_packages(options.assignment):
        raise SystemFault(absent)
    sandbox = Sandbox(sandbox) if isinstance(sandbox, Isolation) else sandbox
    if options.assignment.packages:
        sandbox.close()
        sandbox = Sandbox(with_packages(sandbox.isolation, options.assignment.packages), sandbox.limits)
    for request in requests:
        request.file.open("rb").close()
    processes = min(len(requests), jobs or len(os.sched_getaffinity(0)))
    if processes <= 1:
        yield from _grade_one_by_one(requests, options, sandbox, on_progress)
        return
    yield from grade_in_processes(requests, options, sandbox, processes, on_progress)


def _grade_one_by_one(
    requests: Sequence[GradeRequest],
    options: GradeOptions,
    sandbox: Sandbox,
    on_progress: Callable[[int], None],
) -> Iterator[GradedFile]:
    grader = start_grader(sandbox)
    try:
        for number, request in enumerate(requests, start=1):
            graded = grade_file(grader, options, request)
            on_progress(number)
            yield graded
    finally:
        grader.sandbox.close()
