"""The command ``polhode verify``: compare the reports of an assignment's samples with the expected ones.

Exit codes: 0 if all are as expected, 1 if not, 2 if a sample was not graded because of a system fault or an
assignment is broken.
"""

import argparse
import os
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from fnmatch import fnmatch
from pathlib import Path

from exercises.authoring.assignments import catalogue, course_packages
from exercises.authoring.assignments.assignment import Assignment, InvalidAssignment, NoAssignment
from exercises.authoring.assignments.catalogue import find, load_catalogue
from exercises.authoring.assignments.samples import SampleSet, load_samples, with_entries
from service.cli.arguments import count, seed
from service.cli.output_dir import write
from service.cli.progress import Progress
from service.cli.verify import comparison
from service.cli.verify.course import import_errors
from service.cli.verify.made_samples import verify_made
from service.grading.batch import grade_files
from service.grading.files import GradeOptions, GradeRequest
from service.sandbox.isolation import Isolation
from service.sandbox.select import choose, with_packages
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
    settings = Settings()
    with ThreadPoolExecutor(1) as executor:  # select the sandbox while the assignments are imported
        isolation = executor.submit(choose, settings.min_isolation, settings.allow_root_guest)
        selected, invalid = _select(arguments.assignments)
    sets: list[tuple[Assignment, SampleSet]] = []
    for assignment in selected:
        try:
            sets.append((assignment, load_samples(assignment)))
        except InvalidAssignment as error:
            invalid.append(str(error))
    if not arguments.source:
        packages = {name for assignment in selected for name in assignment.packages}
        invalid += course_packages.errors()
        invalid += import_errors(with_packages(isolation.result(), sorted(packages)))
    for sentence in [*invalid, *course_packages.remarks()]:
        print(f"polhode: {sentence}", file=sys.stderr)
    if arguments.source:
        return _print_source([assignment for assignment, _ in sets], arguments.source)
    jobs = arguments.jobs or idle_processors()
    codes = [2 if invalid or not sets else 0]
    for assignment, found in sets:
        if wrong := comparison.declaration_errors(assignment, arguments.seed):
            print(
                *(f"polhode: assignment {assignment.slug}: {error}" for error in wrong),
                sep="\n",
                file=sys.stderr,
            )
            codes.append(2)
            continue
        own = bool(found.samples or found.unlisted or not assignment.questions)
        if assignment.questions:
            made = {s.name: s for s in assignment.made_samples() if _is_selected(s.name, arguments.only)}
            seeds = range(arguments.seed, arguments.seed + arguments.seeds)
            if made or not own:
                codes.append(
                    verify_made(assignment, made, seeds, isolation.result(), jobs, whole=not arguments.only)
                )
        if own:
            codes.append(_verify_one(assignment, found, arguments, isolation.result(), jobs))
    return max(codes)


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


def _verify_one(
    assignment: Assignment, found: SampleSet, arguments: argparse.Namespace, isolation: Isolation, jobs: int
) -> int:
    listed = [s for s in found.samples if _is_selected(s.file.name, arguments.only)]
    unlisted = [file for file in found.unlisted if _is_selected(file.name, arguments.only)]
    asks = [GradeRequest(s.file, tuple(s.ask) if s.ask else None) for s in listed] + [
        GradeRequest(file) for file in unlisted
    ]
    if not asks:
        print(
            f"polhode: {assignment.slug}: no sample to grade in {assignment.folder / 'samples'}",
            file=sys.stderr,
        )
        return 2
    tally, entries, known = comparison.Tally(), [], {s.file: s for s in listed}
    with Progress(len(asks), "as expected") as progress:
        for graded in grade_files(
            asks, GradeOptions(assignment, arguments.seed), isolation, jobs, progress.update
        ):
            if graded.fault:
                tally.faults += 1
                progress.print(
                    f"?  {graded.file.name}   not graded (system fault): {graded.fault}", good=False
                )
                continue
            sample = known.get(graded.file)
            new = comparison.new_entry(assignment, graded) if arguments.write and sample is None else None
            entries += [new] if new else []
            wrong = list(comparison.differences(sample, graded)) if sample else []
            wrong += [] if sample or new else comparison.missing_entry(assignment, graded)
            tally.add(graded, expected=not wrong)
            head = f"{'✗' if wrong else '✓'}  {graded.file.name}{'   (entry written)' if new else ''}"
            progress.print("\n     ".join([head, *wrong]), good=not wrong)
    if entries:
        write(assignment.folder / "samples" / "expected.toml", with_entries(assignment, entries))
    for line in comparison.summary(assignment, found, tally, whole=not arguments.only and not tally.faults):
        print(line)
    return 2 if tally.faults else 1 if tally.unexpected or found.missing else 0


def _is_selected(name: str, only: Sequence[str] | None) -> bool:
    return not only or any(fnmatch(name, pattern) for pattern in only)
