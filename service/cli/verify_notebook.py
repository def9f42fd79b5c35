"""Verification of an assignment's published notebook and kit: ``ecp.check`` in it finds what the server finds."""

import io
import json
import os
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ecp.notebook.cells import python_of
from ecp.report import Report
from exercises import wheel
from exercises.assignment import Assignment
from exercises.author_notebook import Cell
from exercises.mistakes import MadeSample

TIME_S = 30.0  # for one sample
PROGRAM = Path(__file__).with_name("run_notebook.py")


def notebook_differences(
    assignment: Assignment, samples: Sequence[MadeSample], reports: Mapping[str, Report]
) -> dict[str, list[str]]:
    """Run the published notebook with the students' kit and each of the ``samples``.

    Return, for each, the differences of ``ecp.check`` from the server's ``reports``: an error of a cell, and a public check with
    another verdict. Cells of the notebook that need the right solution may fail with a wrong one; then nothing is compared.
    """
    with tempfile.TemporaryDirectory() as folder:
        kit, job = Path(folder, "kit"), Path(folder, "job.json")
        zipfile.ZipFile(io.BytesIO(wheel.wheel(assignment.slug))).extractall(kit)
        job.write_text(json.dumps(_job(assignment, samples)), encoding="utf-8")
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        for name in assignment.data:
            target = Path(folder, name)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes((assignment.folder / name).read_bytes())
        try:
            ran = subprocess.run(
                [sys.executable, "-I", str(PROGRAM), str(kit), str(job)],
                capture_output=True,
                text=True,
                env=environment,
                cwd=folder,
                timeout=TIME_S * len(samples),
                check=False,
            )
        except subprocess.TimeoutExpired:
            return {samples[0].name: [f"the notebook did not finish with all samples within {TIME_S * len(samples):.0f} s"]}
    if ran.returncode:
        return {samples[0].name: [f"the notebook could not be run: {ran.stderr.strip().splitlines()[-1:]}"]}
    found = json.loads(ran.stdout)
    return {
        sample.name: _differences(sample, found[sample.name], reports[sample.name]) for sample in samples if sample.name in reports
    }


def _job(assignment: Assignment, samples: Sequence[MadeSample]) -> dict[str, Any]:
    names = assignment.functions()
    cells = []
    for cell in json.loads(wheel.notebook(assignment, "http://127.0.0.1", "kit"))["cells"]:
        source, tags = "".join(cell["source"]), cell["metadata"].get("tags", [])
        if cell["cell_type"] == "code":
            skipped = bool({"install", "check", "submit"} & set(tags))
            solution = Cell("code", source, tags=tuple(tags)).is_solution(names)
            cells.append({"source": python_of(source) or "", "skipped": skipped, "solution": solution})
    return {
        "cells": cells,
        "slug": assignment.slug,
        "samples": [{"name": sample.name, "source": sample.source, "ask": list(sample.ask)} for sample in samples],
    }


def _differences(sample: MadeSample, found: Mapping[str, Any], report: Report) -> list[str]:
    """Return the differences. Only the server has a reference for an earlier function, which a remark then names."""
    if "error" in found:
        return [f"in the notebook: {found['error']}"] if sample.right else []
    return [
        f"in the notebook: {found[outcome.id][1]} but on the server: {outcome.line}"
        for outcome in report.outcomes()
        if outcome.id in found and found[outcome.id][0] != outcome.verdict and not outcome.remarks
    ]
