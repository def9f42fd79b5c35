"""Specimens: submissions whose report we know. They hold solutions and never leave the host."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ecp.judge import Verdict
from exercises.assignment import Assignment


@dataclass(frozen=True)
class Specimen:
    """A file with its expected report: a verdict for every check of the exercises graded, and the diagnosis codes named. Where
    anything is wrong, the checks in ``drawn``, of motions drawn for the attempt, have none.

    ``ask`` are the exercises to ask for; None: those the file attempts. Those marked ``demo`` are what ``make demo`` sends.
    """

    file: Path
    ask: list[str] | None
    verdicts: dict[str, Verdict]
    codes: frozenset[str]
    demo: bool
    drawn: frozenset[str]

    def unexpected(self, report: Mapping[str, Any]) -> list[str]:
        """What a report, as JSON, says otherwise, a line each."""
        outcomes = {o["id"]: o for e in report["exercises"] for o in e["outcomes"]}
        told = {id: o["verdict"] for id, o in outcomes.items()}
        found = [f"{id} is {told.get(id)}, not {v}" for id, v in self.verdicts.items() if told.get(id) != v]
        found += [f"{id} was not to be made" for id in set(told) - set(self.verdicts) - self.drawn]
        codes = {d["code"] for o in outcomes.values() for d in o["diagnosis"]}
        return found if codes == self.codes else [*found, f"codes {sorted(codes)}, not {sorted(self.codes)}"]


def specimens(assignment: Assignment) -> list[Specimen]:
    """The specimens of an assignment, as its specimens/expected.toml lists them; ValueError if files and list disagree."""
    folder = assignment.folder / "specimens"
    expected = tomllib.loads((folder / "expected.toml").read_text())
    files = {path.name for path in folder.iterdir() if path.suffix in (".py", ".ipynb")}
    if files != set(expected):
        raise ValueError(f"specimens without or with only an expectation: {sorted(files ^ set(expected))}")
    return [
        Specimen(
            folder / name,
            entry.get("ask"),
            _verdicts(assignment, entry),
            frozenset(entry.get("codes", ())),
            bool(entry.get("demo", False)),
            frozenset(_of_drawn_motions(assignment, entry)),
        )
        for name, entry in expected.items()
    ]


def _verdicts(assignment: Assignment, entry: dict[str, Any]) -> dict[str, Verdict]:
    checks = {c.id: c for number in entry["exercises"] for c in assignment.exercise(number).checks}
    listed = dict.fromkeys(entry.get("fail", ()), Verdict.FAIL) | dict.fromkeys(entry.get("unmeasured", ()), Verdict.UNMEASURED)
    left_out = set(entry.get("left_out", ()))
    if unknown := (set(listed) | left_out) - set(checks):
        raise ValueError(f"expectations for checks that are not made: {sorted(unknown)}")
    if listed:
        left_out |= _of_drawn_motions(assignment, entry)
    return {id: listed.get(id, Verdict.PASS) for id in checks if id not in left_out}


def _of_drawn_motions(assignment: Assignment, entry: dict[str, Any]) -> set[str]:
    """Checks of motions drawn for the attempt: what wrong equations make of one depends on the draw, right, wrong or a stall."""
    checks = [c for number in entry["exercises"] for c in assignment.exercise(number).checks]
    scenes = {s.name for s in assignment.scenes if s.drive is not None and callable(s.inputs)}
    return {c.id for c in checks if scenes & set(c.scenes)}
