"""The command ``polhode import-notebook``: make assignments of published notebooks, with their own validation lines."""

import argparse
import sys
from pathlib import Path


def add(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    command = commands.add_parser(
        "import-notebook",
        help="make an assignment of a published notebook: its validation cells are run and judged again, without points",
    )
    command.add_argument("notebooks", nargs="+", type=Path, metavar="NOTEBOOK", help="a .ipynb file, or a folder with such files")
    command.add_argument(
        "--into", type=Path, metavar="FOLDER", help="where the assignments' folders go (default: the assignments')"
    )
    command.add_argument(
        "--modules", type=Path, metavar="FOLDER", help="the course's own modules, which its notebooks import from ecp"
    )
    command.set_defaults(run=_import)


def _import(arguments: argparse.Namespace) -> int:
    from exercises import catalogue
    from exercises.assignment import InvalidAssignment
    from exercises.author_notebook import InvalidNotebook
    from exercises.importing import imported
    from service.cli.scaffolding import CannotScaffold, created

    into = arguments.into or catalogue.default_folder()
    if into is None:
        print("polhode: name a folder of assignments with --into or POLHODE_ASSIGNMENTS", file=sys.stderr)
        return 2
    files = [file for path in arguments.notebooks for file in _notebooks(path)]
    failed = 0 if files else 1
    for file in files:
        try:
            made = imported(file, arguments.modules)
            files_of = {catalogue.DECLARATION: made.text.encode(), file.name: file.read_bytes(), **made.files}
            folder = created(made.slug, made.title, into, files_of)
            catalogue.register_folder(folder)
            catalogue.find(made.slug)
        except (InvalidNotebook, InvalidAssignment, CannotScaffold, OSError, SyntaxError) as error:
            print(f"polhode: {file}: {error}", file=sys.stderr)
            failed += 1
            continue
        print(f"{folder}: {made.taken} of {made.taken + len(made.left)} validation lines, self-reported")
        for sentence in [*(f"not taken over: {one}" for one in made.left), *made.warnings]:
            print(f"  {sentence}")
    if not files:
        print("polhode: no .ipynb file found", file=sys.stderr)
    return 2 if failed else 0


def _notebooks(path: Path) -> list[Path]:
    if not path.is_dir():
        return [path]
    return sorted(file for file in path.rglob("*.ipynb") if not any(part.startswith(".") for part in file.relative_to(path).parts))
