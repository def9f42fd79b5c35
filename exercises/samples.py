"""Samples: submissions whose report is known. They contain solutions and never leave the host."""

import json
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ecp.judge import Verdict
from exercises.assignment import Assignment, InvalidAssignment


@dataclass(frozen=True)
class Difference:
    """A check whose verdict is not the expected one. None: the check is not expected, or is not in the report."""

    check: str
    expected: Verdict | None
    got: Verdict | None

    def __str__(self) -> str:
        return f"{self.check} is {self.got}, not {self.expected}" if self.expected else f"{self.check} is not expected"


@dataclass(frozen=True)
class Sample:
    """A file with its expected report: a verdict for every check of the graded exercises, and the diagnosis
    codes.

    If anything is wrong, the checks in ``drawn``, of random motions, have no expected verdict. ``ask`` are
    the exercises to grade; None: those the file attempts. Samples marked ``demo`` are submitted by ``make
    demo``.
    """

    file: Path
    ask: list[str] | None
    verdicts: dict[str, Verdict]
    codes: frozenset[str]
    demo: bool
    drawn: frozenset[str]

    def unexpected(self, report: Mapping[str, Any]) -> list[str]:
        """Return the differences of a report, as JSON, from the expected one, one sentence each."""
        found = codes(report)
        wrong = [] if found == self.codes else [f"codes {sorted(found)}, not {sorted(self.codes)}"]
        return [*map(str, self.differences(report)), *wrong]

    def differences(self, report: Mapping[str, Any]) -> list[Difference]:
        """Return the checks of a report, as JSON, that have another verdict or are not expected."""
        got = {o["id"]: Verdict(o["verdict"]) for e in report["exercises"] for o in e["outcomes"]}
        found = [Difference(id, v, got.get(id)) for id, v in self.verdicts.items() if got.get(id) != v]
        return found + [Difference(id, None, got[id]) for id in got if id not in self.verdicts and id not in self.drawn]


@dataclass(frozen=True)
class SampleSet:
    """The ``samples`` of an assignment, files without an expectation, and expectations without a file."""

    samples: list[Sample]
    unlisted: list[Path]
    missing: list[str]


def codes(report: Mapping[str, Any]) -> set[str]:
    """Return the diagnosis codes of a report, as JSON."""
    return {d["code"] for e in report["exercises"] for o in e["outcomes"] for d in o["diagnosis"]}


def load_samples(assignment: Assignment) -> SampleSet:
    """Return the content of the assignment's folder samples/. Raises InvalidAssignment with every error of
    its expected.toml.
    """
    folder = assignment.folder / "samples"
    entries, errors = read(assignment)
    if errors:
        raise InvalidAssignment(assignment.slug, [f"samples/expected.toml: {error}" for error in errors])
    files = {path.name: path for path in sorted(folder.glob("*")) if path.suffix in (".py", ".ipynb")}
    known = [_sample(assignment, files[name], entry) for name, entry in entries.items() if name in files]
    return SampleSet(known, [files[name] for name in files if name not in entries], [name for name in entries if name not in files])


def samples(assignment: Assignment) -> list[Sample]:
    """Return the samples of an assignment as expected.toml lists them. Raises ValueError if files and list
    disagree.
    """
    found = load_samples(assignment)
    if found.unlisted or found.missing:
        names = sorted([*(path.name for path in found.unlisted), *found.missing])
        raise ValueError(f"samples without or with only an expectation: {names}")
    return found.samples


def _sample(assignment: Assignment, file: Path, entry: Mapping[str, Any]) -> Sample:
    named, demo, drawn = frozenset(entry.get("codes", ())), bool(entry.get("demo", False)), frozenset(_drawn(assignment, entry))
    return Sample(file, entry.get("ask"), _verdicts(assignment, entry), named, demo, drawn)


def _verdicts(assignment: Assignment, entry: Mapping[str, Any]) -> dict[str, Verdict]:
    made = [c.id for number in entry["exercises"] for c in assignment.exercise(number).checks]
    wrong = dict.fromkeys(entry.get("fail", ()), Verdict.FAIL) | dict.fromkeys(entry.get("unmeasured", ()), Verdict.UNMEASURED)
    left_out = set(entry.get("left_out", ())) | (_drawn(assignment, entry) if wrong else set())
    return {id: wrong.get(id, Verdict.PASS) for id in made if id not in left_out}


def _drawn(assignment: Assignment, entry: Mapping[str, Any]) -> set[str]:
    """Return the checks of random motions: wrong equations may pass, fail or stall, depending on the motion."""
    checks = [c for number in entry["exercises"] for c in assignment.exercise(number).checks]
    scenes = {s.name for s in assignment.scenes if s.drive is not None and callable(s.inputs)}
    return {c.id for c in checks if scenes & set(c.scenes)}


LISTS = ("ask", "exercises", "left_out", "fail", "unmeasured", "codes")
HEAD = """\
# Expected verdicts of the samples: for each file the exercises asked for (ask; none: those it attempts) and graded (exercises),
# the checks left_out because their function is not there, the checks that fail or are unmeasured, and the diagnosis codes named.
# Every other check of those exercises is ✓. `polhode verify` compares; with --write it adds the files that have no entry.
"""


def read(assignment: Assignment) -> tuple[dict[str, Any], list[str]]:
    """Return the entries of expected.toml by file name, and all of their errors. Without the file there are
    no entries.
    """
    path = assignment.folder / "samples" / "expected.toml"
    try:
        entries = tomllib.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    except ValueError as error:  # not UTF-8, or not TOML
        return {}, [str(error)]
    return entries, [f"{name}: {error}" for name, entry in entries.items() for error in _errors(assignment, entry)]


def entry(name: str, ask: list[str] | None, assignment: Assignment, report: Mapping[str, Any]) -> str:
    """Return the entry that expects exactly this report, given as JSON."""
    graded = [e["number"] for e in report["exercises"]]
    verdicts = {o["id"]: o["verdict"] for e in report["exercises"] for o in e["outcomes"]}
    checks = [c.id for number in graded for c in assignment.exercise(number).checks]
    named = sorted({d["code"] for e in report["exercises"] for o in e["outcomes"] for d in o["diagnosis"]})
    lists = {
        "ask": ask or [],
        "exercises": graded,
        "left_out": [id for id in checks if id not in verdicts],
        "fail": [id for id in checks if verdicts.get(id) == Verdict.FAIL],
        "unmeasured": [id for id in checks if verdicts.get(id) == Verdict.UNMEASURED],
        "codes": named,
    }
    lines = [f"{key} = {_toml(values)}" for key, values in lists.items() if values]
    return "\n".join([f"[{_toml(name)}]", *lines, ""])


def with_entries(assignment: Assignment, entries: Sequence[str]) -> str:
    """Return the text of the file with ``entries`` appended."""
    path = assignment.folder / "samples" / "expected.toml"
    before = path.read_text(encoding="utf-8") if path.exists() else HEAD
    return "\n".join([before.rstrip("\n"), "", *entries])


def _errors(assignment: Assignment, entry: Any) -> Iterator[str]:
    if not isinstance(entry, dict):
        yield "is not a table"
        return
    yield from (f"unknown key {key}" for key in entry if key not in (*LISTS, "demo"))
    lists = {key: entry[key] for key in LISTS if key in entry}
    wrong = [key for key, value in lists.items() if not (isinstance(value, list) and all(isinstance(x, str) for x in value))]
    yield from (f"{key} is not a list of strings" for key in wrong)
    if wrong:
        return
    if not entry.get("exercises"):
        yield "exercises (the numbers of the graded exercises) is missing"
    numbers = {e.number: e for e in assignment.exercises}
    yield from (f"there is no exercise {n}" for n in sorted({*entry.get("exercises", ()), *entry.get("ask", ())} - set(numbers)))
    made = {c.id for n in entry.get("exercises", ()) if n in numbers for c in numbers[n].checks}
    listed = [id for key in ("fail", "unmeasured", "left_out") for id in entry.get(key, ())]
    yield from (f"its exercises have no check {id}" for id in sorted(set(listed) - made))
    yield from (f"the check {id} is listed more than once" for id in sorted({id for id in listed if listed.count(id) > 1}))


def _toml(value: Any) -> str:
    """Return a string, or a list of strings, as TOML: as JSON, except for DEL."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
