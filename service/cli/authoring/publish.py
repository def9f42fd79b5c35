"""The command ``polhode publish``: write an assignment's notebook for students to a file."""

import argparse
from pathlib import Path

from exercises.authoring.assignments import catalogue
from exercises.authoring.publishing import wheel
from polhode.client.kit_hash import WHEEL
from service.cli.errors import CommandError
from service.cli.output_file import write
from service.settings import Settings


def add_publish(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("slug", metavar="SLUG", help="slug of the assignment")
    parser.add_argument(
        "--into",
        type=Path,
        default=Path(),
        metavar="FOLDER",
        help="folder of the file (default: this folder)",
    )
    parser.add_argument("--server", metavar="URL", help="address of the course server (POLHODE_PUBLIC_URL)")
    parser.set_defaults(run=_publish)


def _publish(arguments: argparse.Namespace) -> None:
    assignment = catalogue.find(arguments.slug)
    address = (arguments.server or Settings().public_url or "").rstrip("/")
    file = arguments.into / f"{assignment.slug}.ipynb"
    if not address:
        raise CommandError(
            "the notebook needs the address of the course server: give --server URL or set POLHODE_PUBLIC_URL"
        )
    if arguments.into.resolve() == assignment.folder.resolve():
        raise CommandError(
            f"{file} would lie beside the author's notebook: choose another folder with --into"
        )
    write(file, wheel.notebook(assignment, address, f"{address}/kit/{WHEEL}"))
    print(f"written to {file}")
