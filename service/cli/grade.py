"""polhode grade: files graded here, without server and database.

Exit codes: 0 all ✓, 1 not all, 2 where even one could not be graded: that is our failure, and no verdict.
"""

import argparse
import json
import secrets
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any

from service.cli import report_options

if TYPE_CHECKING:
    from service.grading.result import GradedFile


def add(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    grade = commands.add_parser("grade", help="grade .py and .ipynb files here, without server and database")
    grade.add_argument("files", nargs="+", metavar="FILE", help="a file, a folder of them, or a pattern such as 'class/**/*.ipynb'")
    grade.add_argument("--assignment", metavar="SLUG", help="default: the only one there is, or whose functions they name")
    grade.add_argument("--exercise", action="append", metavar="N", help="grade exercise N; repeatable; default: those attempted")
    grade.add_argument("--seed", type=seed, help="draw the secret scenes from this seed, as a report names it")
    grade.add_argument("--jobs", type=count, metavar="N", help="grade at most N at a time; default: one per processor")
    grade.add_argument("--sweep", action="store_true", help="also chart the function's own speed against accuracy")
    printed = grade.add_mutually_exclusive_group()
    printed.add_argument("--json", action="store_true", help="print the reports as one JSON document and nothing else")
    printed.add_argument("--github", action="store_true", help="annotate lines and write a summary, in GitHub Actions")
    grade.add_argument("--out", type=Path, metavar="DIR", help="write each report with its figures into DIR, and DIR/index.html")
    report_options.add(grade)
    grade.set_defaults(run=_grade)


def count(told: str) -> int:
    """A number of processes."""
    if (number := int(told)) < 1:
        raise argparse.ArgumentTypeError("at least 1")
    return number


def seed(told: str) -> int:
    """What scenes are drawn from."""
    if (number := int(told)) < 0:
        raise argparse.ArgumentTypeError("a seed is 0 or more")
    return number


def _grade(arguments: argparse.Namespace) -> int:
    from service.cli.files import NoSubmissionFound, find_files
    from service.sandbox.result import SystemFault
    from service.sandbox.select import IsolationUnavailable, choose
    from service.settings import Settings

    least = Settings().min_tier
    with ThreadPoolExecutor(1) as beside:  # walls are looked for while the libraries are imported
        looking = beside.submit(choose, least)
        from exercises.assignment import InvalidAssignment, NoAssignment
        from service.cli.files import resolve_assignment
        from service.cli.output_dir import OutputDir
        from service.cli.progress import Progress
        from service.grading.batch import GradeOptions, GradeRequest, grade_files
        from service.grading.grade import UnknownExercise
    try:
        files = find_files(arguments.files)
        assignment = resolve_assignment(arguments.assignment, files)
        seed = secrets.randbits(48) if arguments.seed is None else arguments.seed
        wanted = GradeOptions(assignment, seed, report_options.pictures(arguments), arguments.sweep)
        written = report_options.ReportFiles(arguments, files)
        asks = [GradeRequest(file, tuple(arguments.exercise) if arguments.exercise else None) for file in files]
        folder = OutputDir(arguments.out, files) if arguments.out else None
        graded: list[GradedFile] = []
        with Progress(len(files), guard=report_options.guard(arguments)) as progress:
            for file in grade_files(asks, wanted, looking.result(), arguments.jobs, progress.tell):
                graded.append(file)
                if folder:
                    folder.add(file)
                progress.show(file, text=not arguments.json)
        if folder:
            folder.end(graded, assignment)
        written.write(graded, assignment)
    except BrokenPipeError:
        raise
    except (
        InvalidAssignment,
        NoAssignment,
        NoSubmissionFound,
        UnknownExercise,
        report_options.InvalidOutputOption,
        IsolationUnavailable,
        SystemFault,
        OSError,
    ) as error:
        print(f"polhode: {error}", file=sys.stderr)
        return 2
    _conclude(graded, as_json=arguments.json)
    return 2 if any(file.fault for file in graded) else 0 if all(file.passed for file in graded) else 1


def _conclude(graded: "list[GradedFile]", *, as_json: bool) -> None:
    from service.grading.result import summary

    if as_json:
        print(json.dumps({"reports": [_told(file) for file in graded]}, allow_nan=False))
    elif len(graded) > 1:
        print(summary(graded))


def _told(file: "GradedFile") -> dict[str, Any]:
    from ecp.document import document

    told: dict[str, Any] = {"file": str(file.file), "report": document(file.report) if file.report else None}
    return (
        told
        | ({"error": file.refused} if file.refused else {})
        | ({"fault": file.fault, "system_fault": file.fault} if file.fault else {})
    )
