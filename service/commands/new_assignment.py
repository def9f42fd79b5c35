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
    from exercises.folders import SETTING, home, slugs
    from service.scaffolding import CannotScaffold, scaffold

    slug, into = arguments.slug, arguments.into or home()
    title = arguments.title if arguments.title is not None else slug.replace("-", " ").capitalize()
    try:
        if into is None:
            raise CannotScaffold(
                f"this installation's own folder is not to be written in: give --into FOLDER, and set {SETTING} to it"
            )
        if slug in slugs():
            raise CannotScaffold(f"there is an assignment {slug} already: {slugs()[slug]}")
        folder = scaffold(slug, title, into)
    except (CannotScaffold, OSError) as error:
        print(f"polhode: {error}; nothing was made", file=sys.stderr)
        return 2
    print(f"made {folder}: scenes.py, truth.py, public/ and secret.py ask and judge, causes.py explains, specimens/ try it")
    if slug not in slugs():
        print(f"for the other commands to find it: export {SETTING}={into.resolve()}")
    print(f"next: polhode verify {folder}")
    return 0
