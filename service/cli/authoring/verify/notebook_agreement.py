"""Verification of an assignment's published notebook and kit: ``polhode.check`` in it finds what the server
finds.
"""

import io
import json
import os
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from threading import Timer
from typing import Any

from exercises.authoring.assignments.assignment import Assignment
from exercises.authoring.mutants.variants import MadeSample
from exercises.authoring.publishing import public_assignment, wheel
from exercises.authoring.questions import author_notebook
from polhode.client import cache
from polhode.notebook.cell_to_python import python_of, statements_of
from polhode.report.report import Report

TIME_S = 30.0  # for one sample
PROGRAM = Path(__file__).with_name("run_notebook.py")


def notebook_differences(
    assignment: Assignment,
    samples: Sequence[MadeSample],
    reports: Mapping[str, Report],
    on_progress: Callable[[int], None] = lambda done: None,
) -> dict[str, list[str]]:
    """Run the published notebook with the students' kit and each of the ``samples``, other than the author's
    notebook.

    Return, for each, the differences of ``polhode.check`` from the server's ``reports``: an error of a cell,
    and a public check with another verdict. Cells of the notebook that need the right solution may fail with
    a wrong one; then nothing is compared.
    """
    samples = [sample for sample in samples if sample.name in reports and not sample.is_notebook]
    found: list[Mapping[str, Any]] = []
    with (
        tempfile.TemporaryDirectory() as folder,
        Path(folder, "errors").open("w+", encoding="utf-8") as errors,
    ):
        kit, job = Path(folder, "kit"), Path(folder, "job.json")
        zipfile.ZipFile(io.BytesIO(wheel.wheel())).extractall(kit)
        home = Path(folder, "cache", "polhode", "assignments", assignment.folder.name)
        cache.store(home, public_assignment.archive(assignment.slug), "")
        sent = [{"name": sample.name, "source": sample.source, "ask": list(sample.ask)} for sample in samples]
        run = {"statements": list(_statements(assignment)), "slug": assignment.slug, "samples": sent}
        job.write_text(json.dumps(run), encoding="utf-8")
        for name in assignment.data:
            target = Path(folder, name)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes((assignment.folder / name).read_bytes())
        command = [sys.executable, "-I", str(PROGRAM), str(kit), str(job)]
        with subprocess.Popen(
            command,
            stdout=subprocess.PIPE,
            stderr=errors,
            text=True,
            cwd=folder,
            env={**os.environ, "XDG_CACHE_HOME": str(Path(folder, "cache"))},
        ) as process:
            timer = Timer(TIME_S * len(samples), process.kill)
            timer.start()
            for line in process.stdout or ():
                found.append(json.loads(line))
                on_progress(len(found))
            timer.cancel()
        errors.seek(0)
        late = f"it did not finish within {TIME_S * len(samples):.0f} s"
        stopped = (
            late
            if process.returncode < 0
            else "".join(errors.readlines()[-1:]).strip() or f"exit code {process.returncode}"
        )
    unfinished = [{"stopped": f"the notebook could not be run: {stopped}"}, *[{}] * len(samples)]
    return {
        sample.name: _differences(sample, one, reports[sample.name])
        for sample, one in zip(samples, [*found, *unfinished], strict=False)
    }


def _statements(assignment: Assignment) -> Iterator[dict[str, Any]]:
    """Yield the statements of the published notebook with its solutions: one stands for all of them.

    A student's cell of a solution also sets the names that later cells read: the author's statements do that
    here.
    """
    asked = [question for questions in assignment.questions.values() for question in questions]
    names, solved = (
        {name for question in asked for name in question["variables"] or [question["function"]]},
        False,
    )
    own = next((sample.source for sample in assignment.made_samples() if sample.is_notebook), None)
    cells = author_notebook.parse(own or wheel.notebook(assignment, "http://127.0.0.1", "kit").decode())
    for number, cell in enumerate((cell for cell in cells if cell.kind == "code"), 1):
        parts = [(python_of(cell.source) or "", False)]
        if cell.is_solution(names):
            parts = (
                [(s.text, bool(s.names.bound & names)) for s in statements_of(cell.source)]
                if own
                else [("", True)]
            )
        elif {"install", "check", "submit"} & set(cell.tags):
            continue
        for source, solution in parts:
            if solution and not solved:  # solutions of later exercises run here too
                given = author_notebook.given_constants(cells, names)
                yield {"source": given, "cell": "constants of given cells", "solution": False}
            if not (solution and solved):
                yield {"source": source, "cell": f"code cell {number}", "solution": solution}
            solved |= solution


def _differences(sample: MadeSample, found: Mapping[str, Any], report: Report) -> list[str]:
    """Return the differences. Only the server has a reference for an earlier function, which a remark then
    names.
    """
    if "stopped" in found or "error" in found:
        return (
            [found["stopped"]]
            if "stopped" in found
            else [f"in the notebook: {found['error']}"]
            if sample.right
            else []
        )
    return [
        f"in the notebook: {found[outcome.id][1]} but on the server: {outcome.line}"
        for outcome in report.outcomes()
        if outcome.id in found and found[outcome.id][0] != outcome.verdict and not outcome.remarks
    ]
