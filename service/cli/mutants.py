"""The strength of an assignment's checks: wrong functions graded in the sandbox, and which sets of checks accept them."""

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
POLHODE = "polhode"
"""Name of the full set of checks, next to the author's sets."""


class NoMutants(LookupError):
    """The assignment defines no mutants."""


@dataclass(frozen=True)
class MutantResult:
    """The grading of one mutant. ``wrong``: it differs from the solution by more than rounding; ``accepted``:
    names of the sets of checks that accept it.
    """

    mutant: Mutant
    wrong: bool
    accepted: frozenset[str]

    @property
    def misjudged(self) -> bool:
        """Whether polhode accepts a wrong mutant or rejects a right one."""
        return self.wrong == (POLHODE in self.accepted)


def grade_mutants(assignment: Assignment, most: int | None = None) -> Iterator[MutantResult]:
    """Yield the result of each mutant in the assignment's mutants.py (of the first ``most``), graded by one
    process per core.

    Raises NoMutants if the assignment has no such file.
    """
    if not (assignment.folder / "mutants.py").is_file():
        raise NoMutants(f"{assignment.folder} has no mutants.py")
    source = importlib.import_module(f"exercises.{assignment.folder.name}.mutants")
    mutants = list(source.mutants())[:most]
    isolation = choose(Settings().min_isolation, Settings().allow_root_guest)
    with ProcessPoolExecutor(os.cpu_count(), multiprocessing.get_context("spawn"), grader.start, (isolation,)) as pool:
        asked = [
            pool.submit(grader.grade_one, Submission(m.source), assignment.slug, list(source.EXERCISES), SEED) for m in mutants
        ]
        for mutant, job in zip(mutants, asked, strict=True):
            yield _result(mutant, source, job.result()[0])


def table(found: Sequence[MutantResult]) -> str:
    """Return a Markdown table: for each kind of mutant the number made, the number that turned out correct, and
    how many wrong ones each set of checks accepts.
    """
    kinds = list(dict.fromkeys(f.mutant.kind for f in found))
    judges = sorted(
        {name for f in found for name in f.accepted} | {POLHODE}, key=lambda name: (name == POLHODE, -_accepted(found, name))
    )
    rows = [_row(kind, [f for f in found if f.mutant.kind == kind], judges) for kind in kinds]
    head = f"| changed functions | made | turned out correct | {' | '.join(f'wrong, accepted by {name}' for name in judges)} |"
    return "\n".join([head, "|---" * (3 + len(judges)) + "|", *rows, _row("all", found, judges)])


def _result(mutant: Mutant, source: Any, report: Report) -> MutantResult:
    passed = {o.id for o in report.outcomes() if o.verdict is Verdict.PASS}
    accepted = {name for name, ids in source.LINES.items() if ids <= passed}
    return MutantResult(mutant, source.differs(mutant.source), frozenset(accepted | ({POLHODE} if report.passed else set())))


def _row(kind: str, found: Sequence[MutantResult], judges: Sequence[str]) -> str:
    numbers = [len(found), sum(not f.wrong for f in found), *(_accepted(found, name) for name in judges)]
    return f"| {kind} | {' | '.join(map(str, numbers))} |"


def _accepted(found: Sequence[MutantResult], name: str) -> int:
    return sum(f.wrong and name in f.accepted for f in found)
