"""The command ``polhode chart``: measure the reference methods and chart their cost and where they fail."""

import argparse
from pathlib import Path

from service.cli.errors import CommandError
from service.grading.charts import write_stability, write_work_precision


def add_chart(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("what", choices=["work-precision", "stability"], help="the chart to draw")
    parser.add_argument("--scene", action="append", metavar="NAME", help="only scenes whose name contains NAME; repeatable")
    parser.add_argument(
        "--out", type=Path, default=Path("charts"), metavar="DIR", help="folder for the CSV, JSON and SVG files (default charts)"
    )
    parser.set_defaults(run=_chart)


def _chart(arguments: argparse.Namespace) -> None:
    try:
        write = write_stability if arguments.what == "stability" else write_work_precision
        print(f"written to {write(arguments.scene, arguments.out)}/")
    except ValueError as error:
        raise CommandError(str(error)) from error
    except ModuleNotFoundError as missing:
        if missing.name != "numba":
            raise
        raise CommandError("the reference methods need numba, which is not installed: pip install numba") from missing
