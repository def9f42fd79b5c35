"""The command ``polhode new-assignment``: create an assignment from a working example."""

import argparse
import sys
from pathlib import Path


def add(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    new = commands.add_parser("new-assignment", help="create an assignment of two working exercises to edit")
    new.add_argument("slug", metavar="SLUG", help="lower-case letters, digits and single dashes, such as driven-pendulum")
    new.add_argument("--title", help="title for students; default: the slug's words")
    new.add_argument(
        "--into", type=Path, metavar="FOLDER", help="parent folder; default: where this installation looks for assignments"
    )
    new.set_defaults(run=_new)


def _new(arguments: argparse.Namespace) -> int:
    from exercises import catalogue
    from service.cli.scaffolding import CannotScaffold, scaffold

    slug, into = arguments.slug, arguments.into or catalogue.default_folder()
    title = arguments.title if arguments.title is not None else slug.replace("-", " ").capitalize()
    try:
        if into is None:
            raise CannotScaffold(
                f"cannot write into the installed package: give --into FOLDER, and set {catalogue.SETTING} to FOLDER"
            )
        folder = scaffold(slug, title, into)
    except (CannotScaffold, OSError) as error:
        print(f"polhode: {error}; nothing was created", file=sys.stderr)
        return 2
    print(f"created {folder}")
    if folder.resolve() not in [known.resolve() for known in catalogue.folders()]:
        print(f"to make it known to the other commands and the server: export {catalogue.SETTING}={into.resolve()}")
    print(f"next: polhode verify {folder}")
    return 0
