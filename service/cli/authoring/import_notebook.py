"""The command ``polhode import-notebook``: make assignments of published notebooks, with their own validation
lines, and run each once.
"""

import argparse
import os
import shutil
import sys
import threading
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from exercises.authoring.assignments import catalogue
from exercises.authoring.assignments.assignment import InvalidAssignment
from exercises.authoring.assignments.listing_index import line_counts
from exercises.authoring.importing.assignment_file import Findings, assignment_file
from exercises.authoring.importing.importing import PublishedNotebook, read_published
from exercises.authoring.importing.reported_lines import IN_WORDS
from exercises.authoring.importing.requirements import requirements
from exercises.authoring.importing.validation_words import COURSE_FOLDER
from exercises.authoring.questions.author_notebook import InvalidNotebook
from service.cli.authoring.new_assignment import CannotScaffold, created
from service.cli.errors import CommandError
from service.grading.published.dry_run import DryRun, dry_run
from service.sandbox.isolation.select import IsolationUnavailable, choose, with_packages
from service.sandbox.result import SystemFault
from service.sandbox.sandbox import Sandbox
from service.settings import Settings

REQUIREMENTS, DRY_RUN = "requirements.txt", "dry-run.txt"


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
    names = parser.add_mutually_exclusive_group()
    names.add_argument("--slug", help="the assignment's slug, for one notebook (default: the file's name)")
    names.add_argument("--prefix", default="", help="what each slug begins with, such as ecp-")
    parser.set_defaults(run=_import)


def _import(arguments: argparse.Namespace) -> int:
    into = arguments.into or catalogue.default_folder()
    if into is None:
        raise CommandError("name a folder of assignments with --into or POLHODE_ASSIGNMENTS")
    files = [file for path in arguments.notebooks for file in _notebooks(path)]
    if not files:
        raise CommandError("no .ipynb file found")
    if arguments.slug and len(files) > 1:
        raise CommandError(f"--slug names one assignment, and these are {len(files)} notebooks: use --prefix")
    if arguments.package:
        shutil.copytree(
            arguments.package,
            into / COURSE_FOLDER / arguments.package.resolve().name,
            ignore=shutil.ignore_patterns("__pycache__", ".*"),
            dirs_exist_ok=True,
        )
    wanted = requirements((arguments.package or into / COURSE_FOLDER / "x").parent / REQUIREMENTS)
    made = dict(_created(files, into, wanted, arguments))
    failed = len(files) - len(made)
    for folder, notebook, run in _dry_runs(made):
        failed += not _finish(folder, notebook, run)
    _print_lacking(list(made.values()), wanted)
    return 2 if failed else 0


def _created(
    files: Sequence[Path], into: Path, wanted: Mapping[str, str], arguments: argparse.Namespace
) -> Iterator[tuple[Path, PublishedNotebook]]:
    """Create the folder of each notebook and yield it with the notebook. Print why one cannot be imported."""
    for file in files:
        try:
            notebook = read_published(file, into / COURSE_FOLDER, wanted, arguments.slug, arguments.prefix)
            text = assignment_file(notebook, Findings())
            content = {
                catalogue.DECLARATION: text.encode(),
                file.name: notebook.content,
                **notebook.files,
            }
            folder = created(notebook.slug, notebook.title, into, content)
        except CannotScaffold as error:
            print(f"polhode: {file}: {error}, with --slug or --prefix", file=sys.stderr)
        except (InvalidNotebook, OSError, SyntaxError) as error:
            print(f"polhode: {file}: {error}", file=sys.stderr)
        else:
            if folder.resolve() not in catalogue.folders():
                catalogue.register_folder(into)
            yield folder, notebook


def _dry_runs(
    made: Mapping[Path, PublishedNotebook],
) -> Iterator[tuple[Path, PublishedNotebook, DryRun | None]]:
    """Run each notebook, as many at a time as there are processors. Yield None where that is impossible, and
    print why.
    """
    packages = sorted({name for notebook in made.values() for name in notebook.packages})
    settings = Settings()
    try:
        isolation = with_packages(choose(settings.min_isolation, settings.allow_root_guest), packages)
    except IsolationUnavailable as error:
        print(f"polhode: not run: {error}", file=sys.stderr)
        yield from ((folder, notebook, None) for folder, notebook in made.items())
        return
    own, started = threading.local(), list[Sandbox]()

    def start() -> None:
        own.sandbox = Sandbox(isolation)
        started.append(own.sandbox)

    def run(folder: Path) -> DryRun | None:
        try:
            return dry_run(made[folder], folder, own.sandbox)
        except SystemFault as error:
            print(f"polhode: {made[folder].path}: not run: {error}", file=sys.stderr)
            return None

    with ThreadPoolExecutor(len(os.sched_getaffinity(0)), initializer=start) as pool:
        try:
            yield from zip(made, made.values(), pool.map(run, made), strict=True)
        finally:
            for sandbox in started:
                sandbox.close()


def _finish(folder: Path, notebook: PublishedNotebook, run: DryRun | None) -> bool:
    """Write what a dry run found into the assignment's folder, and print it. Return whether it is valid."""
    if run is not None:
        (folder / catalogue.DECLARATION).write_text(assignment_file(notebook, run.found), encoding="utf-8")
        (folder / DRY_RUN).write_text(run.text(), encoding="utf-8")
    try:
        assignment = catalogue.find(notebook.slug)
    except InvalidAssignment as error:
        print(f"polhode: {notebook.path}: {error}", file=sys.stderr)
        return False
    statuses = line_counts(assignment)
    counts = ", ".join(f"{n} {word}" for status, word in IN_WORDS.items() if (n := statuses.get(status.name)))
    print(f"{folder}: {len(notebook.taken)} of {len(notebook.taken) + len(notebook.left)} lines: {counts}")
    if run is not None:
        print(f"  ran in {run.found.cpu_s:.1f} s of CPU time with {run.found.peak_mb:.0f} MiB")
    found = [*notebook.warnings, *(run.sentences(notebook.taken) if run else ())]
    for sentence in [*(f"not taken over: {one}" for one in notebook.left), *found]:
        print(f"  {sentence}")
    return True


def _print_lacking(made: Sequence[PublishedNotebook], wanted: Mapping[str, str]) -> None:
    """Print each module that this machine lacks, with the notebooks that import it."""
    lacking = defaultdict[str, list[str]](list)
    for notebook in made:
        for name in notebook.lacking:
            lacking[name].append(notebook.path.name)
    for name, needing in lacking.items():
        wants = f" (the course's {REQUIREMENTS}: {wanted[name.lower()]})" if name.lower() in wanted else ""
        print(
            f"{name} is not installed on this machine{wants}; {', '.join(needing)} cannot run without it:"
            " install it and name it in packages, or name the folder of the course's package with --package"
        )


def _notebooks(path: Path) -> list[Path]:
    if not path.is_dir():
        return [path]
    return sorted(
        file
        for file in path.rglob("*.ipynb")
        if not any(part.startswith(".") for part in file.relative_to(path).parts)
    )
