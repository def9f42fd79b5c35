"""Verdicts of every sample, compared with the frozen ones in tests/verdicts.json.

``python -m tests.support.verdicts`` grades every sample of every assignment, and every function of
tests/support/right_on_motions_only.py, in the sandbox with one seed. It prints a line for each difference
and then exits with 1. ``--write`` freezes what it finds instead.
"""

import argparse
import json
import sys
import tempfile
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from exercises.authoring.assignments.assignment import Assignment
from exercises.authoring.assignments.catalogue import assignments
from exercises.authoring.assignments.samples import samples
from polhode.judging.verdict import MARKS
from polhode.report.report import Report
from service.grading.diagnosis import matching_variants
from service.grading.grade_file import GradeOptions, GradeRequest
from service.grading.grade_files import grade_files
from service.grading.graded_file import GradedFile
from service.sandbox.isolation.select import choose
from service.sandbox.time_budget import TimeLimits
from tests.support.right_on_motions_only import sources

FROZEN = Path(__file__).parents[1] / "verdicts.json"
SEED = 1
# of diagnosis: codes must not depend on what else the machine does
PATIENCE = TimeLimits(cpu_s=60.0, wall_s=240.0)
VARIANT_S = 1.0
SHARE = 10  # `make test` grades one sample of so many of each assignment

Record = Mapping[str, Any]
"""What is frozen of one sample: its points, the checks by their marks, and the diagnosis codes."""


@dataclass(frozen=True)
class Subject:
    """A submission to grade: its file name, its source, and the exercises asked for (None: attempted)."""

    name: str
    source: bytes
    ask: tuple[str, ...] | None


def subjects(assignment: Assignment) -> list[Subject]:
    """Return the samples of an assignment; of rigid-body also the functions right on motions only."""
    found = [
        Subject(s.file.name, s.file.read_bytes(), tuple(s.ask) if s.ask else None)
        for s in samples(assignment)
    ]
    found += [Subject(s.name, s.source.encode(), s.ask) for s in assignment.made_samples()]
    if assignment.slug == "rigid-body":
        found += [Subject(f"only_{name}.py", source.encode(), ("2",)) for name, source in sources().items()]
    return found


def graded(assignment: Assignment, chosen: list[Subject], jobs: int | None = None) -> Iterator[GradedFile]:
    """Grade the subjects in the sandbox, and yield their results in order."""
    matching_variants.LIMITS, matching_variants.VARIANT_S = PATIENCE, VARIANT_S
    with tempfile.TemporaryDirectory() as folder:
        requests = [GradeRequest(Path(folder, one.name), one.ask) for one in chosen]
        for request, one in zip(requests, chosen, strict=True):
            request.file.write_bytes(one.source)
        yield from grade_files(requests, GradeOptions(assignment, SEED), choose("namespaces"), jobs)


def record(file: GradedFile) -> Record:
    """Return what is frozen of a grading."""
    if file.report is None:
        return {"refused": file.refused} if file.refused else {"fault": file.fault}
    outcomes = list(file.report.outcomes())
    marks = {mark: [o.id for o in outcomes if MARKS[o.verdict] == mark] for mark in MARKS.values()}
    codes = sorted({d.code for o in outcomes for d in o.diagnosis})
    return {"points": f"{file.report.score} of {file.report.total}", **marks, "codes": codes}


def labels(reports: list[Report]) -> dict[str, str]:
    """Return the labels of the public checks in the reports, by the checks' ids."""
    return {o.id: o.label for report in reports for o in report.outcomes() if not o.hidden}


def difference(before: Record | None, now: Record | None) -> str:
    """Return in one line how a record has changed, "" if it has not."""
    if before == now or before is None or now is None:
        return (
            ""
            if before == now
            else f"{'new' if before is None else 'gone'}: {json.dumps(now or before, ensure_ascii=False)}"
        )
    if before.keys() != now.keys():
        return f"{json.dumps(before, ensure_ascii=False)} → {json.dumps(now, ensure_ascii=False)}"
    parts = [
        f"{key} {before[key]} → {now[key]}"
        for key in before
        if isinstance(now[key], str) and before[key] != now[key]
    ]
    marks = {
        state: {id: mark for mark in MARKS.values() for id in of.get(mark, ())}
        for state, of in (("was", before), ("is", now))
    }
    for id in dict.fromkeys([*marks["was"], *marks["is"]]):
        was, new = marks["was"].get(id, "absent"), marks["is"].get(id, "absent")
        parts += [f"{id} {was} → {new}"] if was != new else []
    parts += [f"code +{code}" for code in now.get("codes", ()) if code not in before["codes"]]
    parts += [f"code −{code}" for code in before.get("codes", ()) if code not in now["codes"]]
    return ", ".join(parts)


def differences(frozen: Mapping[str, Record], found: Mapping[str, Record], *, whole: bool) -> Iterator[str]:
    """Yield a line for each record that is not the frozen one. Only a ``whole`` set lacks none."""
    for name in dict.fromkeys([*found, *(frozen if whole else ())]):
        if changed := difference(frozen.get(name), found.get(name)):
            yield f"{name}: {changed}"


def measure(slugs: list[str], every: int = 1) -> dict[str, Record]:
    """Grade every such subject of the assignments. Return records and public labels by their names."""
    found: dict[str, Record] = {}
    for slug in slugs:
        assignment, public = assignments()[slug], defaultdict[str, str](str)
        for file in graded(assignment, subjects(assignment)[::every]):
            found[f"{slug}/{file.file.name}"] = record(file)
            public |= labels([file.report] if file.report else [])
        found |= {f"{slug}: {id}": {"label": label} for id, label in public.items()}
    return found


def load() -> dict[str, Record]:
    """Return the frozen records by their names."""
    frozen: dict[str, Record] = json.loads(FROZEN.read_text(encoding="utf-8"))
    return frozen


def save(found: Mapping[str, Record]) -> None:
    """Freeze records, a line each, sorted by name."""
    lines = [f"{json.dumps(name)}: {json.dumps(found[name], ensure_ascii=False)}" for name in sorted(found)]
    FROZEN.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


def main() -> int:
    """Run the command line and return its exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("slugs", nargs="*", help="assignments; default: all")
    parser.add_argument("--write", action="store_true", help="freeze what is found")
    arguments = parser.parse_args()
    slugs = arguments.slugs or sorted(assignments())
    found = measure(slugs)
    frozen = (
        {n: r for n, r in load().items() if n.split("/")[0].split(":")[0] in slugs} if FROZEN.exists() else {}
    )
    changed = list(differences(frozen, found, whole=True))
    print(
        "\n".join([*changed, f"{len(found)} verdicts and labels, {len(changed)} differ from {FROZEN.name}"])
    )
    if arguments.write:
        kept = {n: r for n, r in load().items() if n not in frozen} if FROZEN.exists() else {}
        save(kept | found)
        return 0
    return 1 if changed else 0


if __name__ == "__main__":
    sys.exit(main())
