"""The command ``polhode grade``: grade files on this machine, without server or database.

Exit codes: 0 if every line of every attempted exercise is ✓, 1 if not, 2 if a file was not graded because of
a system fault.
"""

import argparse
import json
import secrets
from contextlib import closing
from pathlib import Path
from typing import Any

from polhode.report.dataclass_json import document
from service.cli.arguments import add_exercise, count, seed
from service.cli.batch_progress import Progress
from service.cli.grading import report_options
from service.cli.grading.find_assignment import find_assignment
from service.cli.grading.find_files import find_files
from service.cli.grading.report_folder import ReportFolder
from service.grading.grade_file import GradeOptions, GradeRequest
from service.grading.grade_files import grade_files
from service.grading.graded_file import GradedFile, summary
from service.grading.submission import KIB, MIB, SizeLimits
from service.sandbox.isolation.select import choose
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import TimeLimits
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
    settings, files = Settings(), find_files(arguments.files)
    written = report_options.ReportFiles(arguments, files)
    isolation = choose(settings.min_isolation, settings.allow_root_guest)
    limits = TimeLimits(settings.grading_cpu, settings.grading_wall)
    sizes = SizeLimits(settings.upload_mib * MIB, settings.submission_kib * KIB)
    seed = secrets.randbits(48) if arguments.seed is None else arguments.seed
    graded: list[GradedFile] = []
    with closing(Sandbox(isolation, limits, libraries=False)) as sandbox:
        sandbox.start()  # while this process loads the assignment
        assignment = find_assignment(arguments.assignment, files)
        figures = report_options.pictures(arguments)
        options = GradeOptions(assignment, seed, figures, arguments.sweep, sizes=sizes)
        exercises = tuple(arguments.exercise) if arguments.exercise else None
        requests = [GradeRequest(file, exercises) for file in files]
        folder = ReportFolder(arguments.out, files) if arguments.out else None
        sandbox.self_test()
        with Progress(len(files), escape=report_options.escape(arguments)) as progress:
            for file in grade_files(requests, options, sandbox, arguments.jobs, progress.update):
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


def _entry(file: GradedFile) -> dict[str, Any]:
    entry: dict[str, Any] = {"file": str(file.file), "report": document(file.report) if file.report else None}
    error = {"error": file.refused} if file.refused else {}
    fault = {"system_fault": file.fault} if file.fault else {}
    return entry | error | fault
