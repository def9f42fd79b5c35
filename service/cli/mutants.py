"""The strength of an assignment's checks: wrong functions graded in the sandbox, and which sets of checks accept them."""

import contextlib
import importlib
import itertools
import multiprocessing
import os
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from typing import Any

from ecp.judge import Verdict
from ecp.outcome import Outcome
from ecp.report import Report
from exercises.assignment import Assignment
from exercises.solution import Variant
from service.grading import grader
from service.grading.grade import draw_inputs, job_of
from service.grading.reproduction import play_variants
from service.grading.submission import Submission
from service.sandbox.sandbox import Sandbox
from service.sandbox.select import choose, with_packages
from service.sandbox.time_budget import TimeLimits
from service.settings import Settings

SEED = 1
POLHODE = "polhode"
"""Name of the full set of checks, next to the author's sets."""


LIMITS = TimeLimits(cpu_s=3600, wall_s=7200)  # of a scene with all variants of a question
EQUAL, SIMILAR = 1000.0, 3.0
"""Numbers are right that deviate by a thousandth of what a check allows, or by three times as much as those of the solution."""


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


def grade_mutants(assignment: Assignment, most: int | None = None) -> Iterator[MutantResult]:
    """Yield the result of each mutant (of the first ``most``).

    The mutants are those of the assignment's mutants.py, graded by one process per core, or the generated variants of every
    question of a declaration, judged by the checks of that question. Raises NoMutants if the assignment has neither.
    """
    isolation = choose(Settings().min_isolation, Settings().allow_root_guest)
    if assignment.questions:
        with contextlib.closing(Sandbox(with_packages(isolation, assignment.packages))) as sandbox:
            yield from itertools.islice(_declared(assignment, sandbox), most)
        return
    if not (assignment.folder / "mutants.py").is_file():
        raise NoMutants(f"{assignment.folder} has no mutants.py")
    source = importlib.import_module(f"exercises.{assignment.folder.name}.mutants")
    mutants = list(source.mutants())[:most]
    with ProcessPoolExecutor(os.cpu_count(), multiprocessing.get_context("spawn"), grader.start, (isolation,)) as pool:
        asked = [
            pool.submit(grader.grade_one, Submission(m.source), assignment.slug, list(source.EXERCISES), SEED) for m in mutants
        ]
        for mutant, job in zip(mutants, asked, strict=True):
            yield _result(mutant, source, job.result()[0])


def _declared(assignment: Assignment, sandbox: Sandbox) -> Iterator[MutantResult]:
    for id in [question["id"] for questions in assignment.questions.values() for question in questions]:
        right, *variants = [one for k, one in enumerate(assignment.variants(id)) if k == 0 or not one.declared]
        scenes = [s for s in assignment.scenes if s.question is not None and s.question["id"] == id]
        inputs = {s.name: draw_inputs(s, SEED) for s in scenes}
        job = job_of(Submission(""), assignment, scenes, inputs)
        outcomes: dict[Variant, dict[str, Outcome]] = {variant: {} for variant in (right, *variants)}
        for scene in scenes:
            exact = scene.truth(inputs[scene.name])
            known = {name: exact[name] for name in scene.known}
            checks = [check for check in assignment.checks() if check.scenes == (scene.name,)]
            found = play_variants(job, scene.name, list(outcomes), sandbox, budget_s=scene.budget_s, limits=LIMITS)
            for variant, arrays in found.items():
                outcomes[variant] |= {check.id: check.judge([{**arrays, **known}], [exact]) for check in checks}
        for variant in variants:
            yield _declared_result(variant, outcomes[variant], outcomes[right])


def _declared_result(mutant: Variant, outcomes: Mapping[str, Outcome], right: Mapping[str, Outcome]) -> MutantResult:
    def is_right(outcome: Outcome) -> bool:
        deviation = abs((outcome.measured or 0.0) - (outcome.expected or 0.0))
        solution = abs((right[outcome.id].measured or 0.0) - (outcome.expected or 0.0))
        return deviation <= SIMILAR * solution or (outcome.margin or EQUAL) >= EQUAL

    accepted = outcomes.keys() == right.keys() and all(o.verdict is Verdict.PASS for o in outcomes.values())
    failed = any(o.verdict is Verdict.FAIL for o in outcomes.values())
    equal = accepted and all(map(is_right, outcomes.values()))
    return MutantResult(mutant, not equal, frozenset([POLHODE] if accepted else []), accepted or failed)


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
