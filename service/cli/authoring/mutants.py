"""The strength of an assignment's checks: wrong versions of its right solutions, and which of them the checks
accept.
"""

import argparse
import contextlib
import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from exercises.authoring.assignments.assignment import Assignment, InvalidAssignment, NoAssignment
from exercises.authoring.assignments.catalogue import find
from exercises.authoring.mutants.solution import Variant
from polhode.judging.outcome import Outcome
from polhode.judging.verdict import Verdict
from service.cli.arguments import count
from service.cli.errors import CommandError
from service.grading.diagnosis.matching_variants import play_variants
from service.grading.sandbox_job import draw_inputs, job_of
from service.grading.submission import Submission
from service.sandbox.isolation.select import IsolationUnavailable, choose, with_packages
from service.sandbox.result import SystemFault
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import TimeBudget, TimeLimits
from service.settings import Settings

SEED = 1
LIMITS = TimeLimits(cpu_s=3600, wall_s=7200)  # of a scene with all variants of a question
EQUAL, SIMILAR = 1000.0, 3.0
"""Numbers are right that deviate by a thousandth of what a check allows, or by three times as much as those
of the solution.
"""


def add_mutants(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "assignment", nargs="?", default="rigid-body", help="slug or folder (default rigid-body)"
    )
    parser.add_argument("--most", type=count, metavar="N", help="only the first N mutants")
    parser.set_defaults(run=_mutants)


def _mutants(arguments: argparse.Namespace) -> int:
    try:
        results = list(grade_mutants(find(arguments.assignment), arguments.most))
    except (InvalidAssignment, NoAssignment, SystemFault, IsolationUnavailable) as error:
        raise CommandError(f"cannot grade mutants: {error}") from error
    print(table(results), kill_rate(results), sep="\n")
    kinds = {
        (True, True): "WRONG, BUT ACCEPTED",
        (False, True): "right, but rejected",
        (False, False): "turned out correct",
    }
    for result in results:
        if result.misjudged or not result.wrong:
            what = f"{result.mutant.code}, {result.mutant.sentence}"
            print(f"{kinds[result.wrong, result.misjudged]}: {result.of}: {what}")
    return 1 if any(result.misjudged for result in results) else 0


@dataclass(frozen=True)
class MutantResult:
    """The grading of one mutant ``of`` a function and its exercise.

    ``wrong``: it differs from the solution by more than rounding; ``accepted``: all checks are ✓;
    ``measured``: it returns numbers.
    """

    mutant: Variant
    of: str
    wrong: bool
    accepted: bool
    measured: bool = True

    @property
    def misjudged(self) -> bool:
        """Whether polhode accepts a wrong mutant or rejects a right one."""
        return self.wrong == self.accepted


def grade_mutants(assignment: Assignment, most: int | None = None) -> Iterator[MutantResult]:
    """Yield the result of each mutant (of the first ``most``): the generated variants of every question,
    judged by the checks of that question.
    """
    isolation = choose(Settings().min_isolation, Settings().allow_root_guest)
    with contextlib.closing(Sandbox(with_packages(isolation, assignment.packages))) as sandbox:
        yield from together(itertools.islice(_declared(assignment, sandbox), most))


def _declared(assignment: Assignment, sandbox: Sandbox) -> Iterator[MutantResult]:
    asked = [(number, q) for number, questions in assignment.questions.items() for q in questions]
    for number, question in asked:
        id, of = question["id"], f"{question['function']}, exercise {number}"
        scenes = [s for s in assignment.scenes if s.question is not None and s.question["id"] == id]
        if not scenes:  # the function is asked in an earlier exercise
            continue
        right, *variants = [
            one for k, one in enumerate(assignment.variants(id)) if k == 0 or not one.declared
        ]
        inputs = {s.name: draw_inputs(s, SEED) for s in scenes}
        job = job_of(Submission(""), assignment, scenes, inputs)
        outcomes: dict[Variant, dict[str, Outcome]] = {variant: {} for variant in (right, *variants)}
        for scene in scenes:
            exact = scene.truth(inputs[scene.name])
            known = {name: exact[name] for name in scene.known}
            checks = [check for check in assignment.checks() if check.scenes == (scene.name,)]
            budget = TimeBudget(LIMITS)
            found = play_variants(job, scene.name, list(outcomes), sandbox, budget, budget_s=scene.budget_s)
            for variant, arrays in found.items():
                outcomes[variant] |= {
                    check.id: check.judge([{**arrays, **known}], [exact]) for check in checks
                }
        for variant in variants:
            yield _judged(variant, of, outcomes[variant], outcomes[right])


def together(results: Iterable[MutantResult]) -> Iterator[MutantResult]:
    """Yield one result for each mutant of a function, which several questions, its cases, may judge."""
    found: dict[tuple[str, str], MutantResult] = {}
    for one in results:
        key = one.of, one.mutant.source
        known = found.get(key, one)
        found[key] = replace(
            one,
            wrong=known.wrong or one.wrong,
            accepted=known.accepted and one.accepted,
            measured=known.measured or one.measured,
        )
    yield from found.values()


def _judged(
    mutant: Variant, of: str, outcomes: Mapping[str, Outcome], right: Mapping[str, Outcome]
) -> MutantResult:
    def is_right(outcome: Outcome) -> bool:
        deviation = abs((outcome.measured or 0.0) - (outcome.expected or 0.0))
        solution = abs((right[outcome.id].measured or 0.0) - (outcome.expected or 0.0))
        return deviation <= SIMILAR * solution or (outcome.margin or EQUAL) >= EQUAL

    accepted = outcomes.keys() == right.keys() and all(o.verdict is Verdict.PASS for o in outcomes.values())
    failed = any(o.verdict is Verdict.FAIL for o in outcomes.values())
    equal = accepted and all(map(is_right, outcomes.values()))
    return MutantResult(mutant, of, not equal, accepted, accepted or failed)


def kill_rate(found: Sequence[MutantResult]) -> str:
    """Return how many of the wrong mutants that return numbers polhode rejects."""
    wrong = [f for f in found if f.wrong and f.measured]
    rejected = sum(not f.accepted for f in wrong)
    share = f" ({100 * rejected / len(wrong):.1f} %)" if wrong else ""
    return f"{rejected} of {len(wrong)} wrong functions that return numbers fail a check{share}"


def table(found: Sequence[MutantResult]) -> str:
    """Return a Markdown table: for each kind of mutant the number made, the number that turned out correct,
    and how many wrong ones polhode accepts.
    """
    groups = {
        kind: [f for f in found if f.mutant.code == kind]
        for kind in dict.fromkeys(f.mutant.code for f in found)
    }
    rows = [
        f"| {kind} | {len(of)} | {sum(not f.wrong for f in of)} | {sum(f.wrong and f.accepted for f in of)} |"
        for kind, of in [*groups.items(), ("all", found)]
    ]
    head = "| changed functions | made | turned out correct | wrong, but accepted |\n|---|---|---|---|"
    return "\n".join([head, *rows])
