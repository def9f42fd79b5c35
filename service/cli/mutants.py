"""The strength of an assignment's checks: wrong functions graded in the sandbox, and which sets of checks accept them."""

import functools
import importlib
import itertools
import multiprocessing
import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from typing import Any, NamedTuple

from ecp.judge import Verdict
from ecp.outcome import Outcome
from ecp.report import Report
from exercises.assignment import Assignment
from exercises.solution import Variant
from service.grading import grader
from service.grading.submission import Submission
from service.sandbox.select import choose
from service.settings import Settings

SEED = 1
POLHODE = "polhode"
"""Name of the full set of checks, next to the author's sets."""


EQUAL = 1000.0  # a margin: numbers that differ by a thousandth of what a check allows are those of the right solution


class NoMutants(LookupError):
    """The assignment defines no mutants."""


@dataclass(frozen=True)
class MutantResult:
    """The grading of one mutant. ``wrong``: it differs from the solution by more than rounding; ``accepted``:
    names of the sets of checks that accept it; ``measured``: whether it returns numbers.
    """

    mutant: Variant
    wrong: bool
    accepted: frozenset[str]
    measured: bool = True

    @property
    def misjudged(self) -> bool:
        """Whether polhode accepts a wrong mutant or rejects a right one."""
        return self.wrong == (POLHODE in self.accepted)


class _Asked(NamedTuple):
    """A mutant, the exercises to grade, and what its report means."""

    mutant: Variant
    exercises: list[str]
    result: Callable[[Report], MutantResult | None]


def grade_mutants(assignment: Assignment, most: int | None = None) -> Iterator[MutantResult]:
    """Yield the result of each mutant (of the first ``most``), graded by one process per core.

    The mutants are those of the assignment's mutants.py, or the generated variants of every question of a declaration.
    Raises NoMutants if the assignment has neither.
    """
    asked = list(itertools.islice(_declared(assignment) if assignment.questions else _of_file(assignment), most))
    isolation = choose(Settings().min_isolation, Settings().allow_root_guest)
    with ProcessPoolExecutor(os.cpu_count(), multiprocessing.get_context("spawn"), grader.start, (isolation,)) as pool:
        jobs = [pool.submit(grader.grade_one, Submission(one.mutant.source), assignment.slug, one.exercises, SEED) for one in asked]
        for one, job in zip(asked, jobs, strict=True):
            if result := one.result(job.result()[0]):
                yield result


def _of_file(assignment: Assignment) -> Iterator[_Asked]:
    if not (assignment.folder / "mutants.py").is_file():
        raise NoMutants(f"{assignment.folder} has no mutants.py")
    source = importlib.import_module(f"exercises.{assignment.folder.name}.mutants")
    for mutant in source.mutants():
        yield _Asked(mutant, list(source.EXERCISES), functools.partial(_result, mutant, source))


def _declared(assignment: Assignment) -> Iterator[_Asked]:
    """Yield the right solution of each question, which gives no result, and its generated variants."""
    for number, questions in assignment.questions.items():
        for id in [question["id"] for question in questions]:
            scenes = {s.name for s in assignment.scenes if s.question is not None and s.question["id"] == id}
            checks = {check.id for check in assignment.checks() if scenes.issuperset(check.scenes)}
            right: dict[str, Outcome] = {}
            for mutant in [one for k, one in enumerate(assignment.variants(id)) if k == 0 or not one.declared]:
                yield _Asked(mutant, [number], functools.partial(_declared_result, mutant, checks, right))


def _declared_result(mutant: Variant, checks: set[str], right: dict[str, Outcome], report: Report) -> MutantResult | None:
    outcomes = [o for o in report.outcomes() if o.id in checks]
    if not right:
        right.update({o.id: o for o in outcomes})
        return None
    accepted = all(o.verdict is Verdict.PASS for o in outcomes)
    equal = all(o.measured == right[o.id].measured or (o.margin or EQUAL) >= EQUAL for o in outcomes)
    measured = any(o.verdict is Verdict.FAIL for o in outcomes) or accepted
    return MutantResult(mutant, not (accepted and equal), frozenset([POLHODE] if accepted else []), measured)


def kill_rate(found: Sequence[MutantResult]) -> str:
    """Return how many of the wrong mutants that return numbers polhode rejects."""
    wrong = [f for f in found if f.wrong and f.measured]
    rejected = sum(POLHODE not in f.accepted for f in wrong)
    share = f" ({100 * rejected / len(wrong):.1f} %)" if wrong else ""
    return f"{rejected} of {len(wrong)} wrong functions that return numbers fail a check{share}"


def table(found: Sequence[MutantResult]) -> str:
    """Return a Markdown table: for each kind of mutant the number made, the number that turned out correct, and
    how many wrong ones each set of checks accepts.
    """
    kinds = list(dict.fromkeys(f.mutant.code for f in found))
    judges = sorted(
        {name for f in found for name in f.accepted} | {POLHODE}, key=lambda name: (name == POLHODE, -_accepted(found, name))
    )
    rows = [_row(kind, [f for f in found if f.mutant.code == kind], judges) for kind in kinds]
    head = f"| changed functions | made | turned out correct | {' | '.join(f'wrong, accepted by {name}' for name in judges)} |"
    return "\n".join([head, "|---" * (3 + len(judges)) + "|", *rows, _row("all", found, judges)])


def _result(mutant: Variant, source: Any, report: Report) -> MutantResult:
    passed = {o.id for o in report.outcomes() if o.verdict is Verdict.PASS}
    accepted = {name for name, ids in source.LINES.items() if ids <= passed}
    return MutantResult(mutant, source.differs(mutant.source), frozenset(accepted | ({POLHODE} if report.passed else set())))


def _row(kind: str, found: Sequence[MutantResult], judges: Sequence[str]) -> str:
    numbers = [len(found), sum(not f.wrong for f in found), *(_accepted(found, name) for name in judges)]
    return f"| {kind} | {' | '.join(map(str, numbers))} |"


def _accepted(found: Sequence[MutantResult], name: str) -> int:
    return sum(f.wrong and name in f.accepted for f in found)
