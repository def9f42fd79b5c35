"""The strength of an assignment's checks: wrong versions of a right submission graded in the sandbox, and which of
them the checks accept.
"""

import multiprocessing
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

from ecp.judge import Verdict
from exercises.assignment import Assignment
from exercises.mutation import Variant, variants
from service.grading import grader
from service.grading.submission import Submission
from service.sandbox.select import choose
from service.settings import Settings

SEED = 1


class NoMutants(LookupError):
    """No right submission defines a function whose wrong versions are asked for."""


@dataclass(frozen=True)
class Mutant:
    """The grading of one wrong version of ``function``: whether the public checks alone, and all checks, accept it."""

    function: str
    variant: Variant
    public: bool
    accepted: bool


def grade_mutants(assignment: Assignment, functions: Sequence[str] = (), most: int | None = None) -> Iterator[Mutant]:
    """Yield the result of each wrong version of ``functions``, or of all that the assignment asks for (of the first
    ``most``), graded by one process per core in the exercises that call the function.

    Raises NoMutants if no right submission defines a function.
    """
    versions: list[tuple[str, Variant]] = []
    for function in functions or dict.fromkeys(scene.function for scene in assignment.scenes):
        if (source := assignment.right_submission(function)) is None:
            raise NoMutants(f"no right submission defines {function}: add a sample right_….py")
        versions += [(function, variant) for variant in variants(source, function)]
    isolation = choose(Settings().min_isolation, Settings().allow_root_guest)
    with ProcessPoolExecutor(os.cpu_count(), multiprocessing.get_context("spawn"), grader.start, (isolation,)) as pool:
        graded = [
            pool.submit(grader.grade_one, Submission(variant.source), assignment.slug, _calling(assignment, function), SEED)
            for function, variant in versions[:most]
        ]
        hidden = {check.id for exercise in assignment.exercises for check in exercise.checks if assignment.hidden(check)}
        for (function, variant), job in zip(versions, graded, strict=False):
            rejecting = {outcome.id for outcome in job.result()[0].outcomes() if outcome.verdict is not Verdict.PASS}
            yield Mutant(function, variant, public=rejecting <= hidden, accepted=not rejecting)


def table(found: Sequence[Mutant]) -> str:
    """Return a Markdown table: for each function and each diagnosis code the number of wrong versions, and how many of
    them the public checks alone and all checks accept.
    """
    kinds = dict.fromkeys((mutant.function, mutant.variant.code) for mutant in found)
    rows = [_row(*kind, [m for m in found if (m.function, m.variant.code) == kind]) for kind in kinds]
    head = "| function | changed | made | accepted by the public checks | accepted by all checks |\n|---|---|---|---|---|"
    return "\n".join([head, *rows, _row("all", "", found)])


def _calling(assignment: Assignment, function: str) -> list[str]:
    """Return the numbers of the exercises that call ``function``."""
    named = {scene.name for scene in assignment.scenes if scene.function == function}
    return [e.number for e in assignment.exercises if any(named & {*check.scenes} for check in e.checks)]


def _row(function: str, code: str, found: Sequence[Mutant]) -> str:
    numbers = [len(found), sum(mutant.public for mutant in found), sum(mutant.accepted for mutant in found)]
    return f"| {function} | {code} | {' | '.join(map(str, numbers))} |"
