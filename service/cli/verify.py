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
    from exercises.samples import SampleSet
    from service.sandbox.isolation import Isolation

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
    from service.sandbox.result import SystemFault
    from service.sandbox.select import IsolationUnavailable, choose
    from service.settings import Settings

    with ThreadPoolExecutor(1) as beside:  # selects the isolation level while the assignments are imported
        looking = beside.submit(choose, Settings().min_isolation)
        from exercises import validation
        from exercises.assignment import InvalidAssignment
        from exercises.samples import load_samples

        asked, invalid = _asked(arguments.assignments)
    sets: list[tuple[Assignment, SampleSet]] = []
    for assignment in asked:
        try:
            sets.append((assignment, load_samples(assignment)))
        except InvalidAssignment as error:
            invalid.append(str(error))
        invalid += [f"assignment {assignment.slug}: {error}" for error in validation.public_errors(assignment)]
    for sentence in invalid:
        print(f"polhode: {sentence}", file=sys.stderr)
    codes = [2 if invalid or not sets else 0]
    for assignment, load_catalogue in sets:
        try:
            codes.append(_verify_one(assignment, load_catalogue, arguments, looking.result()))
        except BrokenPipeError:
            raise
        except (IsolationUnavailable, SystemFault, OSError) as error:
            print(f"polhode: {error}", file=sys.stderr)
            return 2
    return max(codes)


def _asked(told: Sequence[str]) -> "tuple[list[Assignment], list[str]]":
    """The assignments meant, and a sentence for each that cannot be used."""
    from exercises.assignment import InvalidAssignment, NoAssignment
    from exercises.catalogue import find, load_catalogue

    if not told:
        return list(load_catalogue().valid.values()), [str(error) for error in load_catalogue().invalid.values()]
    asked, invalid = [], []
    for one in told:
        slugs = _slugs(one)
        invalid += [] if slugs else [f"there is no assignment in {one}"]
        for slug in slugs:
            try:
                asked.append(find(slug))
            except (InvalidAssignment, NoAssignment) as error:
                invalid.append(str(error))
    return asked, invalid


def _slugs(told: str) -> list[str]:
    """Of the assignments meant by a slug, a folder, a folder of samples or one of assignments; those elsewhere are made known."""
    from exercises import catalogue
    from exercises.catalogue import load_catalogue

    if not Path(told).is_dir():
        return [told]
    named = Path(told).resolve()
    meant = catalogue.discover(named.parent if named.name == "samples" else named)
    known = [folder.resolve() for folder in catalogue.folders()]
    for folder in meant:
        if folder not in known:
            catalogue.register_folder(folder)
            load_catalogue.cache_clear()
    return [catalogue.slug_of(folder) for folder in meant]


def _verify_one(
    assignment: "Assignment", load_catalogue: "SampleSet", arguments: argparse.Namespace, isolation: "Isolation"
) -> int:
    from exercises.samples import with_entries
    from service.cli import verification
    from service.cli.output_dir import write
    from service.cli.progress import Progress
    from service.grading.batch import GradeOptions, GradeRequest, grade_files

    load_samples = [s for s in load_catalogue.samples if _is_meant(s.file.name, arguments.only)]
    unlisted = [file for file in load_catalogue.unlisted if _is_meant(file.name, arguments.only)]
    asks = [GradeRequest(s.file, tuple(s.ask) if s.ask else None) for s in load_samples] + [GradeRequest(file) for file in unlisted]
    if not asks:
        print(f"polhode: {assignment.slug}: no sample to grade in {assignment.folder / 'samples'}", file=sys.stderr)
        return 2
    tally, faults, entries, known = verification.Tally(), 0, [], {s.file: s for s in load_samples}
    with Progress(len(asks), "as expected") as progress:
        for graded in grade_files(asks, GradeOptions(assignment, arguments.seed), isolation, arguments.jobs, progress.tell):
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
    for line in verification.summary(assignment, load_catalogue, tally, whole=not arguments.only and not faults):
        print(line)
    return 2 if faults else 1 if tally.otherwise or load_catalogue.missing else 0


def _is_meant(name: str, only: Sequence[str] | None) -> bool:
    return not only or any(fnmatch(name, pattern) for pattern in only)
