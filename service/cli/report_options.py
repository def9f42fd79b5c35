"""Options of ``polhode grade`` that write reports and grades for other systems.

After a system fault no file is written that could be read as a grade; only JUnit's report is, with an error.
"""

import argparse
import json
import math
import os
import secrets
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from exercises.assignment import Assignment
    from service.formats.classroom50 import SubmissionInfo
    from service.grading.result import GradedFile


VISIBILITIES = ("visible", "after_due_date", "after_published", "hidden")
"""When students see a test in Gradescope."""

FILES = ("junit", "csv", "gradescope", "classroom50")


class InvalidOutputOption(ValueError):
    """An output option cannot be satisfied; the message says why."""


def add(grade: argparse.ArgumentParser) -> None:
    """Add the options to the parser."""
    grade.add_argument("--junit", type=Path, metavar="FILE", help="write the reports as JUnit XML")
    grade.add_argument("--csv", type=Path, metavar="FILE", help="write a table of files by checks")
    grade.add_argument("--gradescope", type=Path, metavar="FILE", help="write Gradescope's results.json (for one file only)")
    grade.add_argument("--hidden", choices=VISIBILITIES, help="with --gradescope: visibility of hidden checks (default visible)")
    grade.add_argument(
        "--max-score",
        type=_positive,
        metavar="N",
        help="with --gradescope: points of all checks together; default: the sum of their points",
    )
    grade.add_argument(
        "--classroom50", type=Path, metavar="FILE", help="write Classroom 50's result.json (for one file, in its runner)"
    )


def _positive(text: str) -> float:
    if not 0 < (number := float(text)) < math.inf:
        raise argparse.ArgumentTypeError(f"expected a number above 0, got {text}")
    return number


def pictures(arguments: argparse.Namespace) -> tuple[str, ...]:
    """Return the figure formats that the options need."""
    return ("svg",) * bool(arguments.out) + ("png",) * bool(arguments.gradescope)


def escape(arguments: argparse.Namespace) -> Callable[[str], str] | None:
    """Return a function that keeps GitHub Actions from reading printed lines as commands; None outside GitHub Actions."""
    from service.formats.github import escape_commands

    in_actions = arguments.github or os.environ.get("GITHUB_ACTIONS") == "true"  # for example in pre-commit's hook
    return (lambda text: escape_commands(text, secrets.token_hex(16))) if in_actions else None


class ReportFiles:
    """The output files named by the options.

    The constructor deletes files of an earlier run. It raises InvalidOutputOption if an output is impossible
    for these files.
    """

    def __init__(self, arguments: argparse.Namespace, files: Sequence[Path]) -> None:
        self._arguments, self._about = arguments, None
        if not arguments.gradescope and (arguments.hidden or arguments.max_score):
            raise InvalidOutputOption("--hidden and --max-score apply to Gradescope's results: give --gradescope FILE too")
        for form in ("gradescope", "classroom50"):
            if getattr(arguments, form) and len(files) != 1:
                raise InvalidOutputOption(f"--{form} takes one file, got {len(files)}")
        if arguments.classroom50:
            self._about = _submission_info(files[0])
        for path in filter(None, (getattr(arguments, form) for form in FILES)):
            if path.is_file():
                path.unlink()

    def write(self, graded: "Sequence[GradedFile]", assignment: "Assignment") -> None:
        """Write the output files, with points and checks of the requested exercises only."""
        from service.cli.output_dir import write
        from service.grading.grade import select

        if not any(getattr(self._arguments, form) for form in (*FILES, "github")):
            return
        assignment = replace(assignment, exercises=tuple(select(assignment, self._arguments.exercise)))
        if self._arguments.junit:
            from service.formats import junit

            write(self._arguments.junit, junit.text(graded, assignment))
        if not any(file.fault for file in graded):
            for path, content in self._grades(graded, assignment):
                write(path, content)
        if self._arguments.github:
            _write_github(graded, assignment)

    def _grades(self, graded: "Sequence[GradedFile]", assignment: "Assignment") -> list[tuple[Path, str]]:
        from service.formats import classroom50, grades, gradescope
        from service.formats.grade_row import rows

        found, arguments = [], self._arguments
        if arguments.csv:
            checks = [check.id for check in assignment.checks()]
            found.append((arguments.csv, grades.assignment_csv(rows(graded, assignment), checks)))
        if arguments.gradescope:
            results = gradescope.document(
                graded[0], assignment, max_score=arguments.max_score, hidden=arguments.hidden or "visible"
            )
            found.append((arguments.gradescope, json.dumps(results, indent=1)))
        if self._about:
            document = classroom50.document(graded[0], assignment, self._about)
            found.append((arguments.classroom50, json.dumps(document, indent=1)))
        return found


def _submission_info(file: Path) -> "SubmissionInfo":
    from service.cli.classroom50 import MissingEnvironment, read_environment

    try:
        return read_environment(os.environ, file.parent, datetime.now(UTC))
    except MissingEnvironment as error:
        raise InvalidOutputOption(str(error)) from error


def _write_github(graded: "Sequence[GradedFile]", assignment: "Assignment") -> None:
    """Print annotations to standard output and append to the job summary if the step has one."""
    from service.formats import github

    for annotation in github.annotations(graded, assignment):
        print(annotation)
    try:
        if path := os.environ.get("GITHUB_STEP_SUMMARY"):
            with open(path, "a", encoding="utf-8") as stream:
                stream.write(github.summary(graded, assignment))
    except OSError as error:  # not fatal: the log has the same content
        print(f"polhode: cannot write the job summary: {error}", file=sys.stderr)
