"""The command ``polhode grade``: grade files on this machine, without server or database.

Exit codes: 0 if every check is ✓, 1 if not, 2 if a file was not graded because of a system fault.
"""

import argparse
import json
import secrets
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from ecp.document import document
from service.cli import report_options
from service.cli.arguments import add_exercise, count, seed
from service.cli.files import find_files, resolve_assignment
from service.cli.output_dir import OutputDir
from service.cli.progress import Progress
from service.grading.batch import GradeOptions, GradeRequest, grade_files
from service.grading.result import GradedFile, summary
from service.grading.submission import KIB, MIB, SizeLimits
from service.sandbox.select import choose
from service.sandbox.time_budget import TimeLimits
from service.settings import Settings


def add_grade(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("files", nargs="+", metavar="FILE", help="file, folder, or pattern such as 'class/**/*.ipynb'")
    parser.add_argument(
        "--assignment", metavar="SLUG", help="default: the only assignment, or the one whose functions the files define"
    )
    add_exercise(parser)
    parser.add_argument("--seed", type=seed, help="seed of the hidden scenes, as a report gives it; default: random")
    parser.add_argument("--jobs", type=count, metavar="N", help="grade at most N files at a time; default: one per processor")
    parser.add_argument("--sweep", action="store_true", help="also chart the function's speed against its accuracy")
    printed = parser.add_mutually_exclusive_group()
    printed.add_argument("--json", action="store_true", help="print the reports as one JSON document and nothing else")
    printed.add_argument("--github", action="store_true", help="annotate source lines and write the job summary of GitHub Actions")
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help="write each report with its figures to DIR, and an overview to DIR/index.html"
    )
    report_options.add(parser)
    parser.set_defaults(run=_grade)


def _grade(arguments: argparse.Namespace) -> int:
    settings = Settings()
    with ThreadPoolExecutor(1) as executor:  # select the sandbox while the assignment is imported
        isolation = executor.submit(choose, settings.min_isolation, settings.allow_root_guest)
        files = find_files(arguments.files)
        assignment = resolve_assignment(arguments.assignment, files)
    seed = secrets.randbits(48) if arguments.seed is None else arguments.seed
    limits = TimeLimits(settings.grading_cpu, settings.grading_wall)
    sizes = SizeLimits(settings.upload_mib * MIB, settings.submission_kib * KIB)
    wanted = GradeOptions(assignment, seed, report_options.pictures(arguments), arguments.sweep, limits, sizes)
    written = report_options.ReportFiles(arguments, files)
    asks = [GradeRequest(file, tuple(arguments.exercise) if arguments.exercise else None) for file in files]
    folder = OutputDir(arguments.out, files) if arguments.out else None
    graded: list[GradedFile] = []
    with Progress(len(files), escape=report_options.escape(arguments)) as progress:
        for file in grade_files(asks, wanted, isolation.result(), arguments.jobs, progress.update):
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
    fault = {"fault": file.fault, "system_fault": file.fault} if file.fault else {}
    return entry | error | fault
