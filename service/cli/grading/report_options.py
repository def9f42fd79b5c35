"""Options of ``polhode grade`` that write reports and grades for other systems.

After a system fault no file is written that could be read as a grade; only JUnit's report is, with an error.
"""

import argparse
import json
import math
import os
import secrets
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

from exercises.authoring.assignments.assignment import Assignment
from service.cli.arguments import number
from service.cli.errors import CommandError
from service.cli.grading.classroom50_environment import read_environment
from service.cli.output_file import write
from service.formats import VISIBILITIES, VISIBLE, classroom50, github, grades, gradescope, junit
from service.formats.grade_row import rows
from service.grading.grade import select
from service.grading.graded_file import GradedFile

FILES = ("junit", "csv", "gradescope", "classroom50")


def add(grade: argparse.ArgumentParser) -> None:
    """Add the options to the parser."""
    grade.add_argument("--junit", type=Path, metavar="FILE", help="write the reports as JUnit XML")
    grade.add_argument("--csv", type=Path, metavar="FILE", help="write a table of files by checks")
    grade.add_argument(
        "--gradescope", type=Path, metavar="FILE", help="write Gradescope's results.json (for one file only)"
    )
    grade.add_argument(
        "--hidden",
        choices=VISIBILITIES,
        help="with --gradescope: visibility of hidden checks (default visible)",
    )
    grade.add_argument(
        "--max-score",
        type=number(float, lambda n: 0 < n < math.inf, detail="expected a number above 0"),
        metavar="N",
        help="with --gradescope: points of all checks together; default: the sum of their points",
    )
    grade.add_argument(
        "--classroom50",
        type=Path,
        metavar="FILE",
        help="write Classroom 50's result.json (for one file, in its runner)",
    )


def pictures(arguments: argparse.Namespace) -> tuple[str, ...]:
    """Return the figure formats that the options need."""
    return ("svg",) * bool(arguments.out) + ("png",) * bool(arguments.gradescope)


def escape(arguments: argparse.Namespace) -> Callable[[str], str] | None:
    """Return a function that keeps GitHub Actions from reading printed lines as commands; None outside GitHub
    Actions.
    """
    # the variable tells it for example in pre-commit's hook
    in_actions = arguments.github or os.environ.get("GITHUB_ACTIONS") == "true"
    if not in_actions:
        return None
    return lambda text: github.escape_commands(text, secrets.token_hex(16))


class ReportFiles:
    """The output files named by the options.

    The constructor deletes files of an earlier run. It raises CommandError if an output is impossible
    for these files.
    """

    def __init__(self, arguments: argparse.Namespace, files: Sequence[Path]) -> None:
        self._arguments = arguments
        self._about: classroom50.SubmissionInfo | None = None
        if not arguments.gradescope and (arguments.hidden or arguments.max_score):
            raise CommandError(
                "--hidden and --max-score apply to Gradescope's results: give --gradescope FILE too"
            )
        for form in ("gradescope", "classroom50"):
            if getattr(arguments, form) and len(files) != 1:
                raise CommandError(f"--{form} takes one file, got {len(files)}")
        if arguments.classroom50:
            self._about = read_environment(os.environ, files[0].parent, datetime.now(UTC))
        for path in filter(None, (getattr(arguments, form) for form in FILES)):
            if path.is_file():
                path.unlink()

    def write(self, graded: Sequence[GradedFile], assignment: Assignment) -> None:
        """Write the output files, with points and checks of the requested exercises only."""
        if not any(getattr(self._arguments, form) for form in (*FILES, "github")):
            return
        assignment = replace(assignment, exercises=tuple(select(assignment, self._arguments.exercise)))
        if self._arguments.junit:
            write(self._arguments.junit, junit.text(graded, assignment))
        if not any(file.fault for file in graded):
            for path, content in self._grades(graded, assignment):
                write(path, content)
        if self._arguments.github:
            _write_github(graded, assignment)

    def _grades(self, graded: Sequence[GradedFile], assignment: Assignment) -> Iterator[tuple[Path, str]]:
        arguments = self._arguments
        if arguments.csv:
            checks = [check.id for check in assignment.checks()]
            yield arguments.csv, grades.assignment_csv(rows(graded, assignment), checks)
        if arguments.gradescope:
            hidden = arguments.hidden or VISIBLE
            results = gradescope.document(graded[0], assignment, max_score=arguments.max_score, hidden=hidden)
            yield arguments.gradescope, json.dumps(results, indent=1)
        if self._about:
            yield (
                arguments.classroom50,
                json.dumps(classroom50.document(graded[0], assignment, self._about), indent=1),
            )


def _write_github(graded: Sequence[GradedFile], assignment: Assignment) -> None:
    """Print annotations to standard output and append to the job summary if the step has one."""
    for annotation in github.annotations(graded, assignment):
        print(annotation)
    try:
        if path := os.environ.get("GITHUB_STEP_SUMMARY"):
            with open(path, "a", encoding="utf-8") as stream:
                stream.write(github.summary(graded, assignment))
    except OSError as error:  # not fatal: the log has the same content
        print(f"polhode: cannot write the job summary: {error}", file=sys.stderr)
