"""Specimens: submissions whose report we know. They hold solutions and never leave the host."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ecp.judge import Verdict
from exercises import expected
from exercises.assignment import Assignment, InvalidAssignment


@dataclass(frozen=True)
class Difference:
    """A check whose verdict is not the expected one; None: it was not to be made, or was not made."""

    check: str
    expected: Verdict | None
    got: Verdict | None

    def __str__(self) -> str:
        return f"{self.check} is {self.got}, not {self.expected}" if self.expected else f"{self.check} was not to be made"


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
        told = codes(report)
        wrong = [] if told == self.codes else [f"codes {sorted(told)}, not {sorted(self.codes)}"]
        return [*map(str, self.differences(report)), *wrong]

    def differences(self, report: Mapping[str, Any]) -> list[Difference]:
        """The checks of a report, as JSON, that have another verdict, or that are not to be in it."""
        told = {o["id"]: Verdict(o["verdict"]) for e in report["exercises"] for o in e["outcomes"]}
        found = [Difference(id, v, told.get(id)) for id, v in self.verdicts.items() if told.get(id) != v]
        return found + [Difference(id, None, told[id]) for id in told if id not in self.verdicts and id not in self.drawn]


@dataclass(frozen=True)
class Listed:
    """The ``specimens`` of an assignment; files that have no expectation, and expectations that have no file."""

    specimens: list[Specimen]
    unlisted: list[Path]
    fileless: list[str]


def codes(report: Mapping[str, Any]) -> set[str]:
    """The diagnosis codes of a report, as JSON."""
    return {d["code"] for e in report["exercises"] for o in e["outcomes"] for d in o["diagnosis"]}


def listed(assignment: Assignment) -> Listed:
    """What lies in the assignment's folder specimens/; InvalidAssignment with every error of its expected.toml."""
    folder = assignment.folder / "specimens"
    entries, errors = expected.read(assignment)
    if errors:
        raise InvalidAssignment(assignment.slug, [f"specimens/expected.toml: {error}" for error in errors])
    files = {path.name: path for path in sorted(folder.glob("*")) if path.suffix in (".py", ".ipynb")}
    known = [_specimen(assignment, files[name], entry) for name, entry in entries.items() if name in files]
    return Listed(known, [files[name] for name in files if name not in entries], [name for name in entries if name not in files])


def specimens(assignment: Assignment) -> list[Specimen]:
    """The specimens of an assignment, as its expected.toml lists them; ValueError if files and list disagree."""
    found = listed(assignment)
    if found.unlisted or found.fileless:
        names = sorted([*(path.name for path in found.unlisted), *found.fileless])
        raise ValueError(f"specimens without or with only an expectation: {names}")
    return found.specimens


def _specimen(assignment: Assignment, file: Path, entry: Mapping[str, Any]) -> Specimen:
    named, demo, drawn = frozenset(entry.get("codes", ())), bool(entry.get("demo", False)), frozenset(_drawn(assignment, entry))
    return Specimen(file, entry.get("ask"), _verdicts(assignment, entry), named, demo, drawn)


def _verdicts(assignment: Assignment, entry: Mapping[str, Any]) -> dict[str, Verdict]:
    made = [c.id for number in entry["exercises"] for c in assignment.exercise(number).checks]
    wrong = dict.fromkeys(entry.get("fail", ()), Verdict.FAIL) | dict.fromkeys(entry.get("unmeasured", ()), Verdict.UNMEASURED)
    left_out = set(entry.get("left_out", ())) | (_drawn(assignment, entry) if wrong else set())
    return {id: wrong.get(id, Verdict.PASS) for id in made if id not in left_out}


def _drawn(assignment: Assignment, entry: Mapping[str, Any]) -> set[str]:
    """Checks of motions drawn for the attempt: what wrong equations make of one depends on the draw, right, wrong or a stall."""
    checks = [c for number in entry["exercises"] for c in assignment.exercise(number).checks]
    scenes = {s.name for s in assignment.scenes if s.drive is not None and callable(s.inputs)}
    return {c.id for c in checks if scenes & set(c.scenes)}
