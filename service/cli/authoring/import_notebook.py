"""The command ``polhode import-notebook``: make assignments of published notebooks, with their own validation
lines.
"""

import argparse
import shutil
import sys
from collections import defaultdict
from pathlib import Path

from exercises.authoring.assignments import catalogue, course_packages
from exercises.authoring.assignments.assignment import InvalidAssignment
from exercises.authoring.importing.importing import imported
from exercises.authoring.importing.requirements import requirements
from exercises.authoring.questions.author_notebook import InvalidNotebook
from service.cli.authoring.new_assignment import CannotScaffold, created
from service.cli.errors import CommandError

REQUIREMENTS = "requirements.txt"


def add_import_notebook(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "notebooks",
        nargs="+",
        type=Path,
        metavar="NOTEBOOK",
        help="a .ipynb file, or a folder with such files",
    )
    parser.add_argument(
        "--into",
        type=Path,
        metavar="FOLDER",
        help="where the assignments' folders go (default: the assignments')",
    )
    parser.add_argument(
        "--package",
        type=Path,
        metavar="FOLDER",
        help="the course's own package, which its notebooks import: it is copied to course/ beside them",
    )
    parser.set_defaults(run=_import)


def _import(arguments: argparse.Namespace) -> int:
    into = arguments.into or catalogue.default_folder()
    if into is None:
        raise CommandError("name a folder of assignments with --into or POLHODE_ASSIGNMENTS")
    files = [file for path in arguments.notebooks for file in _notebooks(path)]
    if not files:
        raise CommandError("no .ipynb file found")
    if arguments.package:
        shutil.copytree(
            arguments.package,
            into / course_packages.FOLDER / arguments.package.resolve().name,
            ignore=shutil.ignore_patterns("__pycache__", ".*"),
            dirs_exist_ok=True,
        )
    code, lacking = 0, defaultdict[str, list[str]](list)
    for file in files:
        try:
            made = imported(file, into / course_packages.FOLDER)
            files_of = {catalogue.DECLARATION: made.text.encode(), file.name: file.read_bytes(), **made.files}
            folder = created(made.slug, made.title, into, files_of)
            catalogue.register_folder(folder)
            catalogue.find(made.slug)
        except (InvalidNotebook, InvalidAssignment, CannotScaffold, OSError, SyntaxError) as error:
            print(f"polhode: {file}: {error}", file=sys.stderr)
            code = 2
            continue
        print(f"{folder}: {made.taken} of {made.taken + len(made.left)} validation lines, self-reported")
        for sentence in [*(f"not taken over: {one}" for one in made.left), *made.warnings]:
            print(f"  {sentence}")
        for name in made.lacking:
            lacking[name].append(file.name)
    wanted = requirements((arguments.package or into / course_packages.FOLDER / "x").parent / REQUIREMENTS)
    for name, needing in lacking.items():
        wants = f" (the course's {REQUIREMENTS}: {wanted[name.lower()]})" if name.lower() in wanted else ""
        print(
            f"{name} is not installed on this machine{wants}; {', '.join(needing)} cannot run without it:"
            " install it and name it in packages, or name the folder of the course's package with --package"
        )
    return code


def _notebooks(path: Path) -> list[Path]:
    if not path.is_dir():
        return [path]
    return sorted(
        file
        for file in path.rglob("*.ipynb")
        if not any(part.startswith(".") for part in file.relative_to(path).parts)
    )
