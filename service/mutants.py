"""How strong the checks are, as a number: wrong functions graded behind the walls, and who accepts them."""

import importlib
import multiprocessing
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from typing import Any

from ecp.judge import Verdict
from exercises.assignment import Assignment
from exercises.mutation import Mutant
from service import worker
from service.grading.report import Report
from service.grading.submission import Submission
from service.sandbox.choose import choose
from service.settings import Settings

SEED = 1


@dataclass(frozen=True)
class Fate:
    """What became of a mutant. ``wrong``: it is, by more than rounding; ``by_notebook`` and ``by_us``: who accepts it."""

    mutant: Mutant
    wrong: bool
    by_notebook: bool
    by_us: bool


def fates(assignment: Assignment, most: int | None = None) -> Iterator[Fate]:
    """The fate of each mutant the assignment's folder makes (of the first ``most``), in as many workers as there are cores.

    Raises ModuleNotFoundError for an assignment whose folder has no mutants.py.
    """
    source = importlib.import_module(f"exercises.{assignment.folder.name}.mutants")
    mutants = list(source.mutants())[:most]
    walls = choose(Settings().min_tier)
    with ProcessPoolExecutor(os.cpu_count(), multiprocessing.get_context("spawn"), worker.start, (walls,)) as pool:
        asked = [
            pool.submit(worker.grade_one, Submission(m.source), assignment.slug, list(source.EXERCISES), SEED) for m in mutants
        ]
        for mutant, job in zip(mutants, asked, strict=True):
            yield _fate(mutant, source, Report.model_validate_json(job.result()[0]))


def table(found: Sequence[Fate]) -> str:
    """Markdown: for each kind how many there are, how many are right after all, and who accepts how many of the wrong ones."""
    kinds = list(dict.fromkeys(f.mutant.kind for f in found))
    rows = [_row(kind, [f for f in found if f.mutant.kind == kind]) for kind in kinds]
    head = "| changed functions | made | right after all | wrong, accepted by the notebook's lines | wrong, accepted by ours |"
    return "\n".join([head, "|---|---|---|---|---|", *rows, _row("all", found)])


def _fate(mutant: Mutant, source: Any, report: Report) -> Fate:
    notebook = [o for o in report.outcomes() if o.id in source.NOTEBOOK_LINES]
    passed = bool(notebook) and all(o.verdict is Verdict.PASS for o in notebook)
    return Fate(mutant, wrong=source.differs(mutant.source), by_notebook=passed, by_us=report.passed)


def _row(kind: str, found: Sequence[Fate]) -> str:
    wrong = [f for f in found if f.wrong]
    numbers = (len(found), len(found) - len(wrong), sum(f.by_notebook for f in wrong), sum(f.by_us for f in wrong))
    return f"| {kind} | {' | '.join(map(str, numbers))} |"
