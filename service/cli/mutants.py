"""How strong the checks are, as a number: wrong functions graded in the sandbox, and who accepts them."""

import importlib
import multiprocessing
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from typing import Any

from ecp.judge import Verdict
from ecp.report import Report
from exercises.assignment import Assignment
from exercises.mutation import Mutant
from service.grading import grader
from service.grading.submission import Submission
from service.sandbox.select import choose
from service.settings import Settings

SEED = 1
OURS = "ours"


class NoMutants(LookupError):
    """The assignment makes none."""


@dataclass(frozen=True)
class MutantResult:
    """What became of a mutant. ``wrong``: it is, by more than rounding; ``accepted``: the sets of lines that accept it."""

    mutant: Mutant
    wrong: bool
    accepted: frozenset[str]


def grade_mutants(assignment: Assignment, most: int | None = None) -> Iterator[MutantResult]:
    """The fate of each mutant the assignment's folder makes (of the first ``most``), in as many workers as there are cores."""
    if not (assignment.folder / "mutants.py").is_file():
        raise NoMutants(f"{assignment.folder} has no mutants.py")
    source = importlib.import_module(f"exercises.{assignment.folder.name}.mutants")
    mutants = list(source.mutants())[:most]
    isolation = choose(Settings().min_isolation)
    with ProcessPoolExecutor(os.cpu_count(), multiprocessing.get_context("spawn"), grader.start, (isolation,)) as pool:
        asked = [
            pool.submit(grader.grade_one, Submission(m.source), assignment.slug, list(source.EXERCISES), SEED) for m in mutants
        ]
        for mutant, job in zip(mutants, asked, strict=True):
            yield _fate(mutant, source, job.result()[0])


def table(found: Sequence[MutantResult]) -> str:
    """Markdown: for each kind how many there are, how many are right after all, and who accepts how many of the wrong ones."""
    kinds = list(dict.fromkeys(f.mutant.kind for f in found))
    judges = sorted({name for f in found for name in f.accepted} | {OURS}, key=lambda name: (name == OURS, -_accepted(found, name)))
    rows = [_row(kind, [f for f in found if f.mutant.kind == kind], judges) for kind in kinds]
    head = f"| changed functions | made | right after all | {' | '.join(f'wrong, accepted by {name}' for name in judges)} |"
    return "\n".join([head, "|---" * (3 + len(judges)) + "|", *rows, _row("all", found, judges)])


def _fate(mutant: Mutant, source: Any, report: Report) -> MutantResult:
    passed = {o.id for o in report.outcomes() if o.verdict is Verdict.PASS}
    accepted = {name for name, ids in source.LINES.items() if ids <= passed}
    return MutantResult(mutant, source.differs(mutant.source), frozenset(accepted | ({OURS} if report.passed else set())))


def _row(kind: str, found: Sequence[MutantResult], judges: Sequence[str]) -> str:
    numbers = [len(found), sum(not f.wrong for f in found), *(_accepted(found, name) for name in judges)]
    return f"| {kind} | {' | '.join(map(str, numbers))} |"


def _accepted(found: Sequence[MutantResult], name: str) -> int:
    return sum(f.wrong and name in f.accepted for f in found)
