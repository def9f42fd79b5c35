"""The command ``polhode chart``: measure the reference methods and chart their cost and where they fail, or
draw a submission's function beside them.
"""

import argparse
import json
from pathlib import Path

from ecp.document import document
from service.cli.errors import CommandError
from service.cli.files import resolve_assignment
from service.grading.charts import write_stability, write_work_precision
from service.grading.grade import select
from service.grading.grader import Grader, SweepFailed
from service.grading.rendering import draw_sweep
from service.grading.submission import Submission
from service.sandbox.sandbox import Sandbox
from service.sandbox.select import choose, with_packages
from service.settings import Settings


def add_chart(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("what", choices=["work-precision", "stability"], help="the chart to draw")
    parser.add_argument(
        "--scene", action="append", metavar="NAME", help="only scenes whose name contains NAME; repeatable"
    )
    parser.add_argument(
        "--submission",
        type=Path,
        metavar="FILE",
        help="draw the function in FILE, with the reference methods as measured before",
    )
    parser.add_argument(
        "--assignment",
        metavar="SLUG",
        help="of FILE; default: the only one, or the one whose functions it names",
    )
    parser.add_argument(
        "--exercise", metavar="N", help="the exercise of FILE's function; default: the first that has a chart"
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("charts"),
        metavar="DIR",
        help="folder for the CSV, JSON and SVG files (default charts)",
    )
    parser.set_defaults(run=_chart)


def _chart(arguments: argparse.Namespace) -> None:
    try:
        if arguments.submission:
            _draw_submission(arguments)
        elif arguments.assignment or arguments.exercise:
            raise CommandError("--assignment and --exercise are those of a file: add --submission FILE")
        else:
            write = write_stability if arguments.what == "stability" else write_work_precision
            write(arguments.scene, arguments.out)
        print(f"written to {arguments.out}/")
    except ValueError as error:
        raise CommandError(str(error)) from error
    except ModuleNotFoundError as missing:
        if missing.name != "numba":
            raise
        raise CommandError(
            "the reference methods need numba: install polhode's wheel with its extra charts,"
            " or in a clone run make .venv/tests"
        ) from missing


def _draw_submission(arguments: argparse.Namespace) -> None:
    """Measure the submission's function in the sandbox. Write work-precision-submission.{json,svg}. Raises
    CommandError.
    """
    if arguments.what == "stability" or arguments.scene:
        raise CommandError(
            "a submission is drawn by work-precision, on the motion of its exercise: leave --scene out"
        )
    file, settings = arguments.submission, Settings()
    assignment = resolve_assignment(arguments.assignment, [file])
    asked = [arguments.exercise] if arguments.exercise else []
    if asked and assignment.sweep_of([e.number for e in select(assignment, asked)]) is None:
        charted = [e.number for e in assignment.exercises if assignment.sweep_of([e.number])]
        raise CommandError(
            f"exercise {asked[0]} has no chart of speed against accuracy; these have one:"
            f" {', '.join(charted)}"
        )
    submission = Submission.from_bytes(file.read_bytes(), file.name)
    sandbox = Sandbox(
        with_packages(choose(settings.min_isolation, settings.allow_root_guest), assignment.packages)
    )
    try:
        swept = Grader(sandbox).sweep(submission, assignment, asked)
    except SweepFailed as reason:
        raise CommandError(f"speed and accuracy were not measured: {reason}") from reason
    finally:
        sandbox.close()
    arguments.out.mkdir(parents=True, exist_ok=True)
    (arguments.out / "work-precision-submission.json").write_text(
        json.dumps(document(swept), ensure_ascii=False)
    )
    (arguments.out / "work-precision-submission.svg").write_bytes(draw_sweep(swept))
    print(f"{swept.scene}: {swept.line}")
