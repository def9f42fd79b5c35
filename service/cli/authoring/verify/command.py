"""The command ``polhode verify``: compare the reports of an assignment's samples with the expected ones.

Exit codes: 0 if all are as expected, 1 if not, 2 if a sample was not graded because of a system fault or an
assignment is broken.
"""

import argparse
import os
import sys
from collections.abc import Sequence
from dataclasses import replace
from fnmatch import fnmatch
from pathlib import Path

from exercises.authoring.assignments import catalogue, course_packages
from exercises.authoring.assignments.assignment import Assignment, InvalidAssignment, NoAssignment
from exercises.authoring.assignments.catalogue import find, load_catalogue
from exercises.authoring.assignments.samples import SampleSet, load_samples
from exercises.authoring.importing.line_samples import right_notebooks
from service.cli.arguments import count, seed
from service.cli.authoring.verify.course_packages import import_errors
from service.cli.authoring.verify.line_samples import has_lines, verify_lines
from service.cli.authoring.verify.made_samples import declaration_errors, verify_made
from service.cli.authoring.verify.written_samples import verify_written
from service.sandbox.isolation.levels import Isolation
from service.sandbox.isolation.select import choose, with_packages
from service.settings import Settings

SEED, SEEDS = 1, 4


def add_verify(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "assignments",
        nargs="*",
        metavar="FOLDER",
        help="slug, assignment folder or its samples folder; default: all assignments",
    )
    parser.add_argument(
        "--only", action="append", metavar="NAME", help="only samples with this name or pattern; repeatable"
    )
    parser.add_argument(
        "--jobs",
        type=count,
        metavar="N",
        help="grade at most N samples at a time; default: one per processor that is idle",
    )
    parser.add_argument("--seed", type=seed, default=SEED, help=f"seed of the hidden scenes (default {SEED})")
    parser.add_argument(
        "--seeds",
        type=count,
        default=SEEDS,
        help=f"number of seeds for samples made from a declaration (default {SEEDS})",
    )
    parser.add_argument(
        "--write", action="store_true", help="add an entry to expected.toml for each sample that has none"
    )
    parser.add_argument("--source", metavar="NAME", help="print the source of a sample, and grade nothing")
    parser.set_defaults(run=_verify)


def _verify(arguments: argparse.Namespace) -> int:
    selected, invalid = _select(arguments.assignments)
    sets: list[tuple[Assignment, SampleSet]] = []
    for assignment in selected:
        try:
            sets.append((assignment, load_samples(assignment)))
        except InvalidAssignment as error:
            invalid.append(str(error))
    if arguments.source:
        _print_errors([*invalid, *course_packages.remarks()])
        return _print_source([assignment for assignment, _ in sets], arguments.source)
    settings = Settings()
    isolation = choose(settings.min_isolation, settings.allow_root_guest)
    packages = {name for assignment in selected for name in assignment.packages}
    invalid += course_packages.errors()
    invalid += import_errors(with_packages(isolation, sorted(packages)))
    _print_errors([*invalid, *course_packages.remarks()])
    codes = [_verify_assignment(*one, arguments, isolation) for one in sets]
    return max([2 if invalid or not sets else 0, *codes])


def _verify_assignment(
    assignment: Assignment, found: SampleSet, arguments: argparse.Namespace, isolation: Isolation
) -> int:
    if wrong := declaration_errors(assignment, arguments.seed):
        _print_errors([f"assignment {assignment.slug}: {error}" for error in wrong])
        return 2
    codes = [0]
    jobs, whole = arguments.jobs or idle_processors(), not arguments.only
    lines = has_lines(assignment)
    if lines and whole:
        codes.append(verify_lines(assignment, arguments.seed, isolation, jobs))
        solved = right_notebooks(assignment.folder)  # verified by their lines
        found = replace(found, unlisted=[file for file in found.unlisted if file not in solved])
    own = bool(found.samples or found.unlisted or not (assignment.questions or lines))
    if assignment.questions:
        made = {s.name: s for s in assignment.made_samples() if _is_selected(s.name, arguments.only)}
        seeds = range(arguments.seed, arguments.seed + arguments.seeds)
        if made or not own:
            codes.append(verify_made(assignment, made, seeds, isolation, jobs, whole=whole))
    if own:
        found = SampleSet(
            [sample for sample in found.samples if _is_selected(sample.file.name, arguments.only)],
            [file for file in found.unlisted if _is_selected(file.name, arguments.only)],
            found.missing,
        )
        seed, add_entries = arguments.seed, arguments.write
        codes.append(
            verify_written(assignment, found, seed, isolation, jobs, add_entries=add_entries, whole=whole)
        )
    return max(codes)


def _print_errors(sentences: Sequence[str]) -> None:
    for sentence in sentences:
        print(f"polhode: {sentence}", file=sys.stderr)


def idle_processors() -> int:
    """Return how many processors are idle, at least one: gradings beside other work end as "too busy"."""
    return max(1, len(os.sched_getaffinity(0)) - round(os.getloadavg()[0]))


def _print_source(assignments: Sequence[Assignment], name: str) -> int:
    """Print the source of the sample ``name``. Returns the exit code."""
    for assignment in assignments:
        for sample in assignment.made_samples():
            if sample.name == name:
                print(sample.source)
                return 0
        file = assignment.folder / "samples" / name
        if Path(name).name == name and file.is_file():
            print(file.read_text(encoding="utf-8"))
            return 0
    print(f"polhode: there is no sample {name}; polhode verify lists their names", file=sys.stderr)
    return 2


def _select(names: Sequence[str]) -> tuple[list[Assignment], list[str]]:
    """Return the selected assignments and an error for each one that cannot be used."""
    if not names:
        known, broken = load_catalogue()
        return list(known.values()), [str(error) for error in broken.values()]
    selected, invalid = [], []
    for name in names:
        slugs = _slugs(name)
        invalid += (
            []
            if slugs
            else [f"no assignment found in {name}: name a slug, or a folder that contains assignment.py"]
        )
        for slug in slugs:
            try:
                selected.append(find(slug))
            except (InvalidAssignment, NoAssignment) as error:
                invalid.append(str(error))
    return selected, invalid


def _slugs(name: str) -> list[str]:
    """Return the slugs selected by a slug, an assignment folder, its samples folder or a folder of
    assignments.

    A known slug takes precedence over a folder of that name. Assignments outside the known folders are
    registered.
    """
    if not Path(name).is_dir():
        return [name]
    known, broken = load_catalogue()
    if name.replace("_", "-") in {*known, *broken}:
        return [name]
    named = Path(name).resolve()
    selected = catalogue.discover(named.parent if named.name == "samples" else named)
    folders = [folder.resolve() for folder in catalogue.folders()]
    for folder in selected:
        if folder not in folders:
            catalogue.register_folder(folder)
    return [catalogue.slug_of(folder) for folder in selected]


def _is_selected(name: str, only: Sequence[str] | None) -> bool:
    return not only or any(fnmatch(name, pattern) for pattern in only)
