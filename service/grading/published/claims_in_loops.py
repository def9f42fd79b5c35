"""How many claims each loop of a published notebook makes with the author's solution: a submission whose loop
makes fewer has not shown what the loop is to show.
"""

from collections.abc import Mapping
from pathlib import Path

from exercises.authoring.assignments.assignment import Assignment
from exercises.authoring.importing.line_samples import solved_notebook
from exercises.authoring.importing.reported_lines import reported_lines
from service.grading.sandbox_job import job_of
from service.grading.submission import Submission
from service.sandbox.result import TooBusy
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import TimeBudget

Claims = Mapping[tuple[str, tuple[int, int]], int]
"""The number of claims made at a place of a published cell."""

_known: dict[tuple[object, ...], Claims] = {}


def has_loops(assignment: Assignment) -> bool:
    """Return whether a line of the published notebook is judged by the claims of a loop."""
    return any(line.call.repeated for line in reported_lines(assignment.checks()))


def claims_of_solution(assignment: Assignment, sandbox: Sandbox) -> Claims:
    """Return the claims that loops make with the author's solution: a sample ``right_*``, or the author's
    notebook. Without one, or where it fails, a loop is not in the result.

    The solution is played once, in a child and a time budget of its own. Raises SystemFault if the sandbox
    fails.
    """
    if not has_loops(assignment) or (solution := _solution(assignment)) is None:
        return {}
    key = (assignment.published, solution.source)
    if key not in _known:
        budget = TimeBudget(sandbox.limits.at_least(assignment.cpu_s))
        try:
            result = sandbox.play(job_of(solution, assignment, (), {}), budget=budget)
        except TooBusy:
            return {}
        made = {place: len(claims) for place, claims in result.reported.items()}
        _known[key] = {place: n for place, n in made.items() if place[0] not in result.cells}
    return _known[key]


def _solution(assignment: Assignment) -> Submission | None:
    samples = sorted(
        Path(assignment.folder, "samples").glob("right_*"), key=lambda path: path.suffix != ".ipynb"
    )
    for path in samples:
        if path.suffix in (".ipynb", ".py"):
            return Submission.from_bytes(path.read_bytes(), path.name)
    solved = solved_notebook(assignment)
    return None if solved is None else Submission.from_bytes(solved.encode(), "solved.ipynb")
