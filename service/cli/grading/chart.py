"""The command ``polhode chart``: measure what accuracy costs with the reference methods, and where they
fail.
"""

import argparse
from pathlib import Path

from service.cli.errors import CommandError
from service.grading.figures import method_charts


def add_chart(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("charts"),
        metavar="DIR",
        help="folder for reference.json and the SVG files (default charts)",
    )
    parser.set_defaults(run=_chart)


def _chart(arguments: argparse.Namespace) -> None:
    try:
        method_charts.write(method_charts.measure(), arguments.out)
    except ModuleNotFoundError as missing:
        if missing.name != "numba":
            raise
        raise CommandError(
            "the reference methods need numba: install polhode's wheel with its extra charts,"
            " or in a clone run make .venv/tests"
        ) from missing
    print(f"written to {arguments.out}/")
