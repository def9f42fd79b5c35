"""Samples: submissions whose report is known. They contain solutions and never leave the host."""

import json
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from exercises.authoring.assignments.assignment import Assignment, InvalidAssignment
from polhode.judging.verdict import Verdict


@dataclass(frozen=True)
class Sample:
    """A file with its expected report: a verdict for every check of the graded exercises, and the diagnosis
    codes.

    The checks in ``any`` have no expected verdict: it depends on what is drawn. ``ask`` are the exercises to
    grade; None: those the file attempts. Samples marked ``demo`` are submitted by ``make demo``.
    """

    file: Path
    ask: list[str] | None
    verdicts: dict[str, Verdict]
    codes: frozenset[str]
    demo: bool
    any: frozenset[str]

    def unexpected(self, report: Mapping[str, Any]) -> list[str]:
        """Return the differences of a report, as JSON, from the expected one, one sentence each."""
        found = codes(report)
        wrong = [] if found == self.codes else [f"codes {sorted(found)}, not {sorted(self.codes)}"]
        verdicts, other = _verdicts_of(report), self.differences(report)
        return [
            *(
                f"{id} is {verdicts.get(id)}, not {v}" if v else f"{id} is not expected"
                for id, v in other.items()
            ),
            *wrong,
        ]

    def differences(self, report: Mapping[str, Any]) -> dict[str, Verdict | None]:
        """Return the expected verdict, None if there is none, of each check of a report, as JSON, that has
        another one.
        """
        got = _verdicts_of(report)
        found = {id: v for id, v in self.verdicts.items() if got.get(id) != v}
        return found | {id: None for id in got if id not in self.verdicts and id not in self.any}


@dataclass(frozen=True)
class SampleSet:
    """The ``samples`` of an assignment, files without an expectation, and expectations without a file."""

    samples: list[Sample]
    unlisted: list[Path]
    missing: list[str]


def _verdicts_of(report: Mapping[str, Any]) -> dict[str, Verdict]:
    return {o["id"]: Verdict(o["verdict"]) for e in report["exercises"] for o in e["outcomes"]}


def codes(report: Mapping[str, Any]) -> set[str]:
    """Return the diagnosis codes of a report, as JSON."""
    return {d["code"] for e in report["exercises"] for o in e["outcomes"] for d in o["diagnosis"]}


def load_samples(assignment: Assignment) -> SampleSet:
    """Return the content of the assignment's folder samples/. Raises InvalidAssignment with every error of
    its expected.toml.
    """
    folder = assignment.folder / "samples"
    try:
        entries = tomllib.loads(_expected(assignment) or "")
        errors = [
            f"{name}: {error}" for name, entry in entries.items() for error in _errors(assignment, entry)
        ]
    except ValueError as error:  # not UTF-8, or not TOML
        errors = [str(error)]
    if errors:
        raise InvalidAssignment(assignment.slug, [f"samples/expected.toml: {error}" for error in errors])
    files = {path.name: path for path in sorted(folder.glob("*")) if path.suffix in (".py", ".ipynb")}
    known = [_sample(assignment, files[name], entry) for name, entry in entries.items() if name in files]
    return SampleSet(
        known,
        [files[name] for name in files if name not in entries],
        [name for name in entries if name not in files],
    )


def samples(assignment: Assignment) -> list[Sample]:
    """Return the samples of an assignment as expected.toml lists them. Raises ValueError if files and list
    disagree.
    """
    found = load_samples(assignment)
    if found.unlisted or found.missing:
        names = sorted([*(path.name for path in found.unlisted), *found.missing])
        raise ValueError(f"samples without a file or without an expectation: {names}")
    return found.samples


def _sample(assignment: Assignment, file: Path, entry: Mapping[str, Any]) -> Sample:
    """Return the sample of an entry."""
    checks = [c for number in entry["exercises"] for c in assignment.exercise(number).checks]
    wrong = dict.fromkeys(entry.get("fail", ()), Verdict.FAIL) | dict.fromkeys(
        entry.get("unmeasured", ()), Verdict.UNMEASURED
    )
    drawn = frozenset(entry.get("any", ()))
    left_out = {*entry.get("left_out", ()), *drawn}
    verdicts = {c.id: wrong.get(c.id, Verdict.PASS) for c in checks if c.id not in left_out}
    named, demo = frozenset(entry.get("codes", ())), bool(entry.get("demo", False))
    return Sample(file, entry.get("ask"), verdicts, named, demo, drawn)


LISTS = ("ask", "exercises", "left_out", "fail", "unmeasured", "any", "codes")
HEAD = (
    "# Expected verdicts of the samples: for each file the exercises asked for (ask; none: those it attempts)"
    " and graded (exercises),\n"
    "# the checks left_out because their function is not defined, the checks that fail or are unmeasured,"
    " and the diagnosis codes.\n"
    "# Every other check of those exercises is ✓. `polhode verify` compares; with --write it adds the files"
    " that have no entry.\n"
)


def _expected(assignment: Assignment) -> str | None:
    """Return the text of expected.toml, None if there is no such file."""
    path = assignment.folder / "samples" / "expected.toml"
    return path.read_text(encoding="utf-8") if path.exists() else None


def entry(name: str, ask: list[str] | None, assignment: Assignment, report: Mapping[str, Any]) -> str:
    """Return the entry that expects exactly this report, given as JSON."""
    graded = [e["number"] for e in report["exercises"]]
    verdicts = _verdicts_of(report)
    checks = [c.id for number in graded for c in assignment.exercise(number).checks]
    lists = {
        "ask": ask or [],
        "exercises": graded,
        "left_out": [id for id in checks if id not in verdicts],
        "fail": [id for id in checks if verdicts.get(id) == Verdict.FAIL],
        "unmeasured": [id for id in checks if verdicts.get(id) == Verdict.UNMEASURED],
        "codes": sorted(codes(report)),
    }
    lines = [f"{key} = {_toml(values)}" for key, values in lists.items() if values]
    return "\n".join([f"[{_toml(name)}]", *lines, ""])


def with_entries(assignment: Assignment, entries: Sequence[str]) -> str:
    """Return the text of the file with ``entries`` appended."""
    before = _expected(assignment)
    return "\n".join([(HEAD if before is None else before).rstrip("\n"), "", *entries])


def _errors(assignment: Assignment, entry: Any) -> Iterator[str]:
    if not isinstance(entry, dict):
        yield "is not a table"
        return
    yield from (f"unknown key {key}" for key in entry if key not in (*LISTS, "demo"))
    lists = {key: entry[key] for key in LISTS if key in entry}
    wrong = [
        key
        for key, value in lists.items()
        if not (isinstance(value, list) and all(isinstance(x, str) for x in value))
    ]
    yield from (f"{key} is not a list of strings" for key in wrong)
    if wrong:
        return
    if not entry.get("exercises"):
        yield "exercises (the numbers of the graded exercises) is missing"
    numbers = {e.number: e for e in assignment.exercises}
    yield from (
        f"there is no exercise {n}"
        for n in sorted({*entry.get("exercises", ()), *entry.get("ask", ())} - set(numbers))
    )
    made = {c.id for n in entry.get("exercises", ()) if n in numbers for c in numbers[n].checks}
    listed = [id for key in ("fail", "unmeasured", "left_out", "any") for id in entry.get(key, ())]
    yield from (f"its exercises have no check {id}" for id in sorted(set(listed) - made))
    yield from (
        f"the check {id} is listed more than once"
        for id in sorted({id for id in listed if listed.count(id) > 1})
    )


def _toml(value: Any) -> str:
    """Return a string, or a list of strings, as TOML: as JSON, except for DEL."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
