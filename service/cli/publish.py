"""The command ``polhode publish``: write an assignment's notebook for students to a file."""

import argparse
import sys
from pathlib import Path


def add(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    publish = commands.add_parser("publish", help="write the students' notebook of an assignment, without solutions, to SLUG.ipynb")
    publish.add_argument("slug", metavar="SLUG", help="slug of the assignment")
    publish.add_argument("--into", type=Path, default=Path(), metavar="FOLDER", help="folder of the file (default: this folder)")
    publish.add_argument("--server", metavar="URL", help="address of the course server (POLHODE_PUBLIC_URL)")
    publish.set_defaults(run=_publish)


def _publish(arguments: argparse.Namespace) -> int:
    from exercises import catalogue, wheel
    from exercises.assignment import InvalidAssignment, NoAssignment
    from service.cli.output_dir import write
    from service.settings import Settings

    try:
        assignment = catalogue.find(arguments.slug)
        server = arguments.server or Settings().public_url
        file = arguments.into / f"{assignment.slug}.ipynb"
        error = ""
        if not server:
            error = "the notebook needs the address of the course server: give --server URL or set POLHODE_PUBLIC_URL"
        elif arguments.into.resolve() == assignment.folder.resolve():
            error = f"{file} would lie beside the author's notebook: choose another folder with --into"
        else:
            address = server.rstrip("/")
            write(file, wheel.notebook(assignment, address, f"{address}/kit/{wheel.filename(assignment.slug)}"))
    except (InvalidAssignment, NoAssignment, OSError) as failure:
        error = str(failure)
    if error:
        print(f"polhode: {error}", file=sys.stderr)
        return 2
    print(f"written to {file}")
    return 0
