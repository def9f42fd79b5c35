"""Dry runs of a published notebook: its given cells in the sandbox, without a student and with the author's
solutions.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exercises.authoring.importing.assignment_file import Findings
from exercises.authoring.importing.importing import PublishedNotebook
from exercises.authoring.importing.self_reported_checks import Placed
from exercises.authoring.importing.student_influence import (
    computing,
    computing_cells,
    influenced,
    is_independent,
)
from polhode.judging.verdict import Verdict
from service.grading.judge_exercise import NOT_DEFINED
from service.sandbox.job import Cell, Job
from service.sandbox.result import CellCost, PlayResult
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import TimeBudget, TimeLimits

CELL_S, MEMORY_MB = 60.0, 4096  # reference cells of courses take up to a minute
LIMITS = TimeLimits(cpu_s=600.0, wall_s=1200.0)


@dataclass(frozen=True)
class Run:
    """What the cells of a published notebook did: what each ``costs`` that ended, by its name, the sentence
    about each that fails for another reason than a name that the student defines, and the lines that are ✓.
    """

    costs: Mapping[str, CellCost] = field(default_factory=dict)
    failures: Mapping[str, str] = field(default_factory=dict)
    passed: Sequence[Placed] = ()


@dataclass(frozen=True)
class DryRun:
    """The dry runs of a notebook: with emptied solutions, with the author's if there are any, and what they
    ``found`` for its declaration.
    """

    emptied: Run
    solved: Run | None
    found: Findings

    @property
    def failures(self) -> dict[str, str]:
        """The sentence about each cell that fails, by its name."""
        return {**(self.solved.failures if self.solved else {}), **self.emptied.failures}

    def sentences(self, lines: Sequence[Placed]) -> Iterator[str]:
        """Yield a sentence for each cell that fails, and for each line that is not ✓ with the solutions."""
        yield from (f"{name} fails: {sentence}" for name, sentence in self.failures.items())
        for line in lines if self.solved else ():
            if self.solved and line not in self.solved.passed:
                yield f"{line.cell.name}: with your solutions this line is not ✓: {line.call.label}"

    def text(self) -> str:
        """Return what each cell used and how it ended, as a table."""
        return "\n".join(["cell                     CPU s   MiB so far", *self._rows()])

    def _rows(self) -> Iterator[str]:
        for title, run in (("emptied solution cells", self.emptied), ("the author's solutions", self.solved)):
            if run is not None:
                yield f"# {title}"
                names = dict.fromkeys([*run.costs, *run.failures])
                for name in names:
                    cost = run.costs.get(name)
                    used = f"{cost.cpu_s:7.2f} {cost.peak_mb:8.0f}" if cost else " " * 16
                    yield f"{name:22} {used}  {run.failures.get(name, '')}".rstrip()


def dry_run(notebook: PublishedNotebook, folder: Path, sandbox: Sandbox) -> DryRun:
    """Run the given cells of a notebook, whose data files are in ``folder``, with emptied solution cells, and
    with the author's solutions if it has some. Raises SystemFault.
    """
    data = {name: folder / name for name in notebook.files}
    given = [Cell(cell.name, cell.source, published=True) for cell in notebook.cells if cell.is_given]
    emptied = _run(given, notebook, data, sandbox, students=influenced(notebook.cells))
    every = [Cell(cell.name, cell.source, published=cell.is_given) for cell in notebook.cells]
    solved = _run(every, notebook, data, sandbox, students=()) if notebook.has_solutions else None
    costs = [cost for run in (emptied, solved) if run is not None for cost in run.costs.values()]
    found = Findings(
        without_student=emptied.passed,
        truths=dict(_truths(notebook, data, sandbox)),
        cell_s=max((cost.cpu_s for cost in costs), default=0.0),
        cpu_s=sum(cost.cpu_s for cost in costs),
        peak_mb=max((cost.peak_mb for cost in costs), default=0.0),
        has_solutions=notebook.has_solutions,
    )
    return DryRun(emptied, solved, found)


def _run(
    cells: Sequence[Cell],
    notebook: PublishedNotebook,
    data: Mapping[str, Path],
    sandbox: Sandbox,
    *,
    students: Collection[str],
) -> Run:
    """Run cells. A cell may fail for the lack of names that only ``students`` define."""
    result = _played(cells, data, sandbox)
    failures = {
        name: end.sentence
        for name, end in result.cells.items()
        if not ((found := NOT_DEFINED.search(end.sentence)) and found[1] in students)
    }
    return Run(result.costs, failures, [line for line in notebook.taken if _passes(line, result)])


def _truths(
    notebook: PublishedNotebook, data: Mapping[str, Path], sandbox: Sandbox
) -> Iterator[tuple[Placed, NDArray[Any]]]:
    """Yield the expected value of each line whose value no student's cell can influence, if it is the same
    when it is computed twice.
    """
    names = influenced(notebook.cells)
    wanted = [line for line in notebook.taken if is_independent(line, names)]
    cells = [Cell(*one, published=True) for one in computing_cells(notebook.cells, wanted, names)]
    result = _played(cells, data, sandbox) if wanted else PlayResult()
    computed = {cell: claims[0].arrays for (cell, _), claims in result.reported.items()}
    for line in wanted:
        arrays = computed.get(computing(line), {})
        value, again = arrays.get("expected"), arrays.get("got")
        same = value is not None and again is not None and np.array_equal(value, again)
        if value is not None and same and np.all(np.isfinite(value)):
            yield line, value


def _played(cells: Sequence[Cell], data: Mapping[str, Path], sandbox: Sandbox) -> PlayResult:
    job = Job("", "", tuple(cells), (), (), load_budget_s=CELL_S, memory_mb=MEMORY_MB, data=data)
    return sandbox.play(job, budget=TimeBudget(LIMITS))


def _passes(line: Placed, result: PlayResult) -> bool:
    claims = result.reported.get((line.cell.name, line.call.place), [])
    return bool(claims) and all(claim.judged().verdict is Verdict.PASS for claim in claims)
