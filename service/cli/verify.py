"""polhode verify: are the samples of an assignment graded as its author expects?

Exit codes: 0 all as expected, 1 not all, 2 where one could not be graded or an assignment is broken.
"""

import argparse
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from fnmatch import fnmatch
from pathlib import Path
from typing import TYPE_CHECKING

from service.cli.grade import count, seed

if TYPE_CHECKING:
    from exercises.assignment import Assignment
    from exercises.samples import Listed
    from service.sandbox.isolation import Walls

SEED = 1


def add(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    verify = commands.add_parser("verify", help="grade the samples of assignments and compare with what is expected of them")
    verify.add_argument(
        "assignments", nargs="*", metavar="FOLDER", help="slug, folder or folder of samples; default: all there are"
    )
    verify.add_argument("--only", action="append", metavar="NAME", help="only samples of that name or pattern; repeatable")
    verify.add_argument("--jobs", type=count, metavar="N", help="grade at most N at a time; default: one per processor")
    verify.add_argument("--seed", type=seed, default=SEED, help=f"draw the secret scenes from this seed (default {SEED})")
    verify.add_argument("--write", action="store_true", help="add an entry to expected.toml for each sample that has none")
    verify.set_defaults(run=_verify)


def _verify(arguments: argparse.Namespace) -> int:
    from service.sandbox.result import Fault
    from service.sandbox.select import WallsMissing, choose
    from service.settings import Settings

    with ThreadPoolExecutor(1) as beside:  # walls are looked for while the assignments are imported
        looking = beside.submit(choose, Settings().min_tier)
        from exercises import validation
        from exercises.assignment import InvalidAssignment
        from exercises.samples import listed

        asked, broken = _asked(arguments.assignments)
    sets: list[tuple[Assignment, Listed]] = []
    for assignment in asked:
        try:
            sets.append((assignment, listed(assignment)))
        except InvalidAssignment as error:
            broken.append(str(error))
        broken += [f"assignment {assignment.slug}: {error}" for error in validation.public_errors(assignment)]
    for sentence in broken:
        print(f"polhode: {sentence}", file=sys.stderr)
    codes = [2 if broken or not sets else 0]
    for assignment, found in sets:
        try:
            codes.append(_verify_one(assignment, found, arguments, looking.result()))
        except BrokenPipeError:
            raise
        except (WallsMissing, Fault, OSError) as error:
            print(f"polhode: {error}", file=sys.stderr)
            return 2
    return max(codes)


def _asked(told: Sequence[str]) -> "tuple[list[Assignment], list[str]]":
    """The assignments meant, and a sentence for each that cannot be used."""
    from exercises.assignment import InvalidAssignment, NoAssignment
    from exercises.catalogue import find, found

    if not told:
        return list(found().sound.values()), [str(error) for error in found().broken.values()]
    asked, broken = [], []
    for one in told:
        slugs = _slugs(one)
        broken += [] if slugs else [f"there is no assignment in {one}"]
        for slug in slugs:
            try:
                asked.append(find(slug))
            except (InvalidAssignment, NoAssignment) as error:
                broken.append(str(error))
    return asked, broken


def _slugs(told: str) -> list[str]:
    """Of the assignments meant by a slug, a folder, a folder of samples or one of assignments; those elsewhere are made known."""
    from exercises import catalogue
    from exercises.catalogue import found

    if not Path(told).is_dir():
        return [told]
    named = Path(told).resolve()
    meant = catalogue.within(named.parent if named.name == "samples" else named)
    known = [folder.resolve() for folder in catalogue.folders()]
    for folder in meant:
        if folder not in known:
            catalogue.add(folder)
            found.cache_clear()
    return [catalogue.slug_of(folder) for folder in meant]


def _verify_one(assignment: "Assignment", found: "Listed", arguments: argparse.Namespace, walls: "Walls") -> int:
    from exercises.samples import with_entries
    from service.cli import verification
    from service.cli.output_dir import write
    from service.cli.progress import Progress
    from service.grading.batch import Ask, Wanted, grade_files

    listed = [s for s in found.samples if _is_meant(s.file.name, arguments.only)]
    unlisted = [file for file in found.unlisted if _is_meant(file.name, arguments.only)]
    asks = [Ask(s.file, tuple(s.ask) if s.ask else None) for s in listed] + [Ask(file) for file in unlisted]
    if not asks:
        print(f"polhode: {assignment.slug}: no sample to grade in {assignment.folder / 'samples'}", file=sys.stderr)
        return 2
    tally, faults, entries, known = verification.Tally(), 0, [], {s.file: s for s in listed}
    with Progress(len(asks), "as expected") as progress:
        for graded in grade_files(asks, Wanted(assignment, arguments.seed), walls, arguments.jobs, progress.tell):
            if graded.fault:
                faults += 1
                progress.say(f"?  {graded.file.name}   not graded: {graded.fault}", good=False)
                continue
            sample = known.get(graded.file)
            new = verification.new_entry(assignment, graded) if arguments.write and sample is None else None
            entries += [new] if new else []
            wrong = verification.differences(sample, graded) if sample else []
            wrong += [] if sample or new else verification.unlisted(assignment, graded)
            tally.add(graded, expected=not wrong)
            head = f"{'✗' if wrong else '✓'}  {graded.file.name}{'   (entry written)' if new else ''}"
            progress.say("\n     ".join([head, *wrong]), good=not wrong)
    if entries:
        write(assignment.folder / "samples" / "expected.toml", with_entries(assignment, entries))
    for line in verification.summary(assignment, found, tally, whole=not arguments.only and not faults):
        print(line)
    return 2 if faults else 1 if tally.otherwise or found.fileless else 0


def _is_meant(name: str, only: Sequence[str] | None) -> bool:
    return not only or any(fnmatch(name, pattern) for pattern in only)
