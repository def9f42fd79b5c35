"""The command ``polhode export``: an assignment for another grading system."""

import argparse
import sys
from pathlib import Path


def add(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    export = commands.add_parser("export", help="export an assignment for another grading system")
    forms = export.add_subparsers(dest="form", required=True)
    gradescope = forms.add_parser("gradescope", help="write the autograder zip to upload to Gradescope")
    gradescope.add_argument("--assignment", metavar="SLUG", help="default: the only assignment")
    gradescope.add_argument(
        "--exercise", action="append", metavar="N", help="grade exercise N; repeatable; default: the attempted exercises"
    )
    gradescope.add_argument("--out", type=Path, required=True, metavar="FILE.zip", help="zip file to write")
    gradescope.set_defaults(run=_gradescope)


def _gradescope(arguments: argparse.Namespace) -> int:
    from exercises.assignment import InvalidAssignment, NoAssignment
    from service.cli.files import resolve_assignment
    from service.cli.gradescope_bundle import bundle
    from service.cli.output_dir import write
    from service.grading.grade import UnknownExercise, select

    try:
        assignment = resolve_assignment(arguments.assignment, [])
        select(assignment, arguments.exercise)
        write(arguments.out, bundle(assignment, arguments.exercise))
    except (InvalidAssignment, NoAssignment, UnknownExercise, OSError) as error:
        print(f"polhode: {error}", file=sys.stderr)
        return 2
    points = assignment.max_points(arguments.exercise)
    print(f"written to {arguments.out}: upload it as the autograder and set the autograder points to {points}")
    return 0
