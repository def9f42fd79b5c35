"""The command ``polhode grade``: grade files on this machine, without server or database.

Exit codes: 0 if every line of every attempted exercise is ✓, 1 if not, 2 if a file was not graded because of
a system fault.
"""

import argparse
import gc
import json
import secrets
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from service.cli import report_options
from service.cli.arguments import add_exercise, count, seed
from service.cli.files import find_files, resolve_assignment
from service.cli.grading_settings import Defaults, read_settings
from service.cli.lazy_imports import import_lazily

if TYPE_CHECKING:
    from service.cli.output_dir import OutputDir
    from service.grading.result import GradedFile
    from service.sandbox.guest_process import GuestProcess
    from service.sandbox.isolation import Isolation
    from service.sandbox.sandbox import Sandbox
    from service.settings import Settings


def add_grade(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "files", nargs="+", metavar="FILE", help="file, folder, or pattern such as 'class/**/*.ipynb'"
    )
    parser.add_argument(
        "--assignment",
        metavar="SLUG",
        help="default: the only assignment, or the one whose functions the files define",
    )
    add_exercise(parser)
    parser.add_argument(
        "--seed", type=seed, help="seed of the hidden scenes, as a report gives it; default: random"
    )
    parser.add_argument(
        "--jobs", type=count, metavar="N", help="grade at most N files at a time; default: one per processor"
    )
    parser.add_argument(
        "--sweep", action="store_true", help="also chart the function's speed against its accuracy"
    )
    printed = parser.add_mutually_exclusive_group()
    printed.add_argument(
        "--json", action="store_true", help="print the reports as one JSON document and nothing else"
    )
    printed.add_argument(
        "--github",
        action="store_true",
        help="annotate source lines and write the job summary of GitHub Actions",
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help="write each report with its figures to DIR, and an overview to DIR/index.html",
    )
    report_options.add(parser)
    parser.set_defaults(run=_grade)


def _grade(arguments: argparse.Namespace) -> int:
    settings, files = read_settings(), find_files(arguments.files)
    written = report_options.ReportFiles(arguments, files)
    with _starting(settings) as self_tested:  # while this process imports the modules below
        with _no_collection():
            import_lazily()
            from service.cli.progress import Progress
            from service.grading.batch import grade_files
            from service.grading.files import GradeOptions, GradeRequest
            from service.grading.result import summary
            from service.grading.submission import KIB, MIB, SizeLimits

            sandbox = self_tested()
            assignment = resolve_assignment(arguments.assignment, files)
        seed = secrets.randbits(48) if arguments.seed is None else arguments.seed
        sizes = SizeLimits(settings.upload_mib * MIB, settings.submission_kib * KIB)
        wanted = GradeOptions(
            assignment, seed, report_options.pictures(arguments), arguments.sweep, sizes=sizes
        )
        asks = [
            GradeRequest(file, tuple(arguments.exercise) if arguments.exercise else None) for file in files
        ]
        folder = _output_dir(arguments.out, files) if arguments.out else None
        graded: list[GradedFile] = []
        with Progress(len(files), escape=report_options.escape(arguments)) as progress:
            for file in grade_files(asks, wanted, sandbox.result(), arguments.jobs, progress.update):
                graded.append(file)
                if folder:
                    folder.add(file)
                progress.show(file, text=not arguments.json)
    if folder:
        folder.write_index(graded, assignment)
    written.write(graded, assignment)
    if arguments.json:
        print(json.dumps({"reports": [_entry(file) for file in graded]}, allow_nan=False))
    elif len(graded) > 1:
        print(summary(graded))
    return 2 if any(file.fault for file in graded) else 0 if all(file.passed for file in graded) else 1


def _output_dir(out: Path, files: list[Path]) -> "OutputDir":
    from service.cli.output_dir import OutputDir  # only here, as it imports all of a report's HTML

    return OutputDir(out, files)


@contextmanager
def _no_collection() -> Iterator[None]:
    """Collect no garbage in the ``with`` block, nor later what was made there: that would take a quarter of
    the time of imports.
    """
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()


@contextmanager
def _starting(settings: "Settings | Defaults") -> Iterator[Callable[[], "Future[Sandbox]"]]:
    """Start a guest in namespaces if bubblewrap is installed: it imports its libraries while this process
    imports its own.

    Yield a function that begins the self-test of a sandbox with that guest in a thread, and returns the
    future of the sandbox. Call it only after importing the modules that the thread also needs: two threads
    cannot import NumPy at once.
    """
    from service.sandbox.guest_process import GuestProcess
    from service.sandbox.select import prepare_namespaces

    prepared = prepare_namespaces(settings.allow_root_guest)
    first = GuestProcess(prepared.command, prepared.environment, libraries=False) if prepared else None
    started: Future[Sandbox] | None = None
    with ThreadPoolExecutor(1) as executor:

        def self_tested() -> "Future[Sandbox]":
            nonlocal started
            started = executor.submit(_self_tested, settings, prepared, first)
            return started

        try:
            yield self_tested
        finally:
            if started is None and first:
                first.kill()
            if started and started.exception() is None:
                started.result().close()


def _self_tested(
    settings: "Settings | Defaults", prepared: "Isolation | None", first: "GuestProcess | None"
) -> "Sandbox":
    """Return a sandbox of the strongest isolation that this machine supports: with the guest ``first``,
    unless it cannot start.
    """
    from service.sandbox.result import SystemFault
    from service.sandbox.sandbox import Sandbox
    from service.sandbox.select import choose
    from service.sandbox.time_budget import TimeLimits

    limits = TimeLimits(settings.grading_cpu, settings.grading_wall)
    sandbox = Sandbox(prepared, limits, first) if prepared else None
    try:
        try:
            if sandbox:
                sandbox.wait_ready()
        except SystemFault:  # this machine lacks namespaces, or the guest cannot start at any level
            sandbox = None  # its guest has been killed
        sandbox = sandbox or Sandbox(choose(settings.min_isolation, settings.allow_root_guest), limits)
        sandbox.self_test()
    except BaseException:
        if sandbox:
            sandbox.close()
        raise
    return sandbox


def _entry(file: "GradedFile") -> dict[str, Any]:
    from polhode.report.document import document

    entry: dict[str, Any] = {"file": str(file.file), "report": document(file.report) if file.report else None}
    error = {"error": file.refused} if file.refused else {}
    fault = {"system_fault": file.fault} if file.fault else {}
    return entry | error | fault
