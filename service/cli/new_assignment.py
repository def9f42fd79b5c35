"""polhode new-assignment: a folder that works, to be changed step by step."""

import argparse
import sys
from pathlib import Path


def add(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    new = commands.add_parser("new-assignment", help="make the folder of a new assignment, which polhode verify accepts as it is")
    new.add_argument("slug", metavar="SLUG", help="such as driven-pendulum: small letters, digits and single dashes")
    new.add_argument("--title", help="as students read it; default: the slug's words")
    new.add_argument("--into", type=Path, metavar="FOLDER", help="where to put it; default: where this installation looks for them")
    new.set_defaults(run=_new)


def _new(arguments: argparse.Namespace) -> int:
    from exercises import catalogue
    from service.cli.scaffolding import CannotScaffold, scaffold

    slug, into = arguments.slug, arguments.into or catalogue.default_folder()
    title = arguments.title if arguments.title is not None else slug.replace("-", " ").capitalize()
    try:
        if into is None:
            raise CannotScaffold(
                f"an installed package is no place for it: give --into FOLDER, and set {catalogue.SETTING} to FOLDER"
            )
        folder = scaffold(slug, title, into)
    except (CannotScaffold, OSError) as error:
        print(f"polhode: {error}; nothing was made", file=sys.stderr)
        return 2
    print(f"made {folder}")
    if folder.resolve() not in [known.resolve() for known in catalogue.folders()]:
        print(f"so that the other commands and the server find it: export {catalogue.SETTING}={into.resolve()}")
    print(f"next: polhode verify {folder}")
    return 0
