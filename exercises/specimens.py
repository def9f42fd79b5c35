"""Specimens: submissions whose report we know. They hold solutions and never leave the host."""

import tomllib
from dataclasses import dataclass
from pathlib import Path

from ecp.judge import Verdict
from exercises.assignment import Assignment


@dataclass(frozen=True)
class Specimen:
    """A file with its expected report: a verdict for every check of the exercises graded, and the diagnosis codes named.

    ``ask`` are the exercises to ask for; None: those the file attempts.
    """

    file: Path
    ask: list[str] | None
    verdicts: dict[str, Verdict]
    codes: frozenset[str]


def specimens(assignment: Assignment) -> list[Specimen]:
    """The specimens of an assignment, as its specimens/expected.toml lists them; ValueError if files and list disagree."""
    folder = assignment.folder / "specimens"
    expected = tomllib.loads((folder / "expected.toml").read_text())
    files = {path.name for path in folder.iterdir() if path.suffix in (".py", ".ipynb")}
    if files != set(expected):
        raise ValueError(f"specimens without or with only an expectation: {sorted(files ^ set(expected))}")
    return [
        Specimen(folder / name, entry.get("ask"), _verdicts(assignment, entry), frozenset(entry.get("codes", ())))
        for name, entry in expected.items()
    ]


def _verdicts(assignment: Assignment, entry: dict[str, list[str]]) -> dict[str, Verdict]:
    checks = [c.id for number in entry["exercises"] for c in assignment.exercise(number).checks]
    listed = dict.fromkeys(entry.get("fail", ()), Verdict.FAIL) | dict.fromkeys(entry.get("unmeasured", ()), Verdict.UNMEASURED)
    left_out = set(entry.get("left_out", ()))
    if unknown := (set(listed) | left_out) - set(checks):
        raise ValueError(f"expectations for checks that are not made: {sorted(unknown)}")
    return {id: listed.get(id, Verdict.PASS) for id in checks if id not in left_out}
