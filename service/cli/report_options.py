"""What polhode grade leaves for other systems: files of grades, and words for GitHub Actions.

After a fault of ours there is no file that somebody could take for a grade: only JUnit's report, where it is an error.
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
    from service.formats.classroom50 import About
    from service.grading.result import GradedFile


VISIBILITIES = ("visible", "after_due_date", "after_published", "hidden")
"""When students see a test in Gradescope."""


FILES = ("junit", "csv", "gradescope", "classroom50")


class InvalidOutputOption(ValueError):
    """What was asked for cannot be written; the message tells why."""


def add(grade: argparse.ArgumentParser) -> None:
    """Add the options."""
    grade.add_argument("--junit", type=Path, metavar="FILE", help="write JUnit XML")
    grade.add_argument("--csv", type=Path, metavar="FILE", help="write a table of files by checks")
    grade.add_argument("--gradescope", type=Path, metavar="FILE", help="write the results.json of one file")
    grade.add_argument("--hidden", choices=VISIBILITIES, default="visible", help="there, of checks that ask what nobody knows")
    grade.add_argument("--max-score", type=_positive, metavar="N", help="there, of all checks together; default: a point each")
    grade.add_argument("--classroom50", type=Path, metavar="FILE", help="write the result.json of one file, in its runner")


def _positive(told: str) -> float:
    if not 0 < (number := float(told)) < math.inf:
        raise argparse.ArgumentTypeError("more than 0")
    return number


def pictures(arguments: argparse.Namespace) -> tuple[str, ...]:
    """The kinds of figures that are needed."""
    return ("svg",) * bool(arguments.out) + ("png",) * bool(arguments.gradescope)


def guard(arguments: argparse.Namespace) -> Callable[[str], str] | None:
    """In GitHub Actions what makes words of students such that none of their lines is a command; elsewhere None."""
    from service.formats.github import escape_commands

    in_actions = arguments.github or os.environ.get("GITHUB_ACTIONS") == "true"  # such as pre-commit's hook
    return (lambda words: escape_commands(words, secrets.token_hex(16))) if in_actions else None


class ReportFiles:
    """The forms asked for; Unfit, before anything is graded, where one of them cannot be had of these files."""

    def __init__(self, arguments: argparse.Namespace, files: Sequence[Path]) -> None:
        self._arguments, self._about = arguments, None
        for form in ("gradescope", "classroom50"):
            if getattr(arguments, form) and len(files) != 1:
                raise InvalidOutputOption(f"--{form} tells of one file, and there are {len(files)}")
        if arguments.classroom50:
            self._about = _about(files[0])
        for path in filter(None, (getattr(arguments, form) for form in FILES)):
            if path.is_file():
                path.unlink()  # what an earlier run left there is no grade of this one

    def write(self, graded: "Sequence[GradedFile]", assignment: "Assignment") -> None:
        """Write them; of points and checks there are those of the exercises asked for."""
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
            _tell_github(graded, assignment)

    def _grades(self, graded: "Sequence[GradedFile]", assignment: "Assignment") -> list[tuple[Path, str]]:
        from service.formats import classroom50, grades_csv, gradescope
        from service.formats.grade_row import rows

        found, arguments = [], self._arguments
        if arguments.csv:
            checks = [check.id for check in assignment.checks()]
            found.append((arguments.csv, grades_csv.assignment_csv(rows(graded, assignment), checks)))
        if arguments.gradescope:
            results = gradescope.document(graded[0], assignment, max_score=arguments.max_score, hidden=arguments.hidden)
            found.append((arguments.gradescope, json.dumps(results, indent=1)))
        if self._about:
            document = classroom50.document(graded[0], assignment, self._about)
            found.append((arguments.classroom50, json.dumps(document, indent=1)))
        return found


def _about(file: Path) -> "About":
    from service.cli.classroom50 import MissingEnvironment, read_environment

    try:
        return read_environment(os.environ, file.parent, datetime.now(UTC))
    except MissingEnvironment as error:
        raise InvalidOutputOption(str(error)) from error


def _tell_github(graded: "Sequence[GradedFile]", assignment: "Assignment") -> None:
    """Annotations on standard output, and the summary where the step has one."""
    from service.formats import github

    for annotation in github.annotations(graded, assignment):
        print(annotation)
    try:
        if path := os.environ.get("GITHUB_STEP_SUMMARY"):
            with open(path, "a", encoding="utf-8") as stream:
                stream.write(github.summary(graded, assignment))
    except OSError as error:  # it repeats what the log tells, and is no grade
        print(f"polhode: no summary: {error}", file=sys.stderr)
