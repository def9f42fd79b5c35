"""specimens/expected.toml: what report each specimen is to get. Read with all its errors, and written entry by entry."""

import json
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ecp.judge import Verdict
from exercises.assignment import Assignment

LISTS = ("ask", "exercises", "left_out", "fail", "unmeasured", "codes")
HEAD = """\
# Expected verdicts of the specimens: for each file the exercises asked for (ask; none: those it attempts) and graded (exercises),
# the checks left_out because their function is not there, the checks that fail or are unmeasured, and the diagnosis codes named.
# Every other check of those exercises is ✓. `polhode verify` compares; with --write it adds the files that have no entry.
"""


def read(assignment: Assignment) -> tuple[dict[str, Any], list[str]]:
    """Its entries by file name, and everything that is wrong with them. No file: no entries."""
    path = assignment.folder / "specimens" / "expected.toml"
    try:
        entries = tomllib.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    except ValueError as error:  # no UTF-8, or no TOML
        return {}, [str(error)]
    return entries, [f"{name}: {error}" for name, entry in entries.items() for error in _errors(assignment, entry)]


def entry(name: str, ask: list[str] | None, assignment: Assignment, report: Mapping[str, Any]) -> str:
    """A report, as JSON, as the entry that expects just this."""
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
    """The text of the file with these at its end; what stands in it stays as it is."""
    path = assignment.folder / "specimens" / "expected.toml"
    before = path.read_text(encoding="utf-8") if path.exists() else HEAD
    return "\n".join([before.rstrip("\n"), "", *entries])


def _errors(assignment: Assignment, entry: Any) -> Iterator[str]:
    if not isinstance(entry, dict):
        yield "is no table"
        return
    yield from (f"no key is called {key}" for key in entry if key not in (*LISTS, "demo"))
    lists = {key: entry[key] for key in LISTS if key in entry}
    wrong = [key for key, value in lists.items() if not (isinstance(value, list) and all(isinstance(x, str) for x in value))]
    yield from (f"{key} is no list of strings" for key in wrong)
    if wrong:
        return
    if not entry.get("exercises"):
        yield "exercises, the numbers of those graded, is missing"
    numbers = {e.number: e for e in assignment.exercises}
    yield from (f"there is no exercise {n}" for n in sorted({*entry.get("exercises", ()), *entry.get("ask", ())} - set(numbers)))
    made = {c.id for n in entry.get("exercises", ()) if n in numbers for c in numbers[n].checks}
    told = [id for key in ("fail", "unmeasured", "left_out") for id in entry.get(key, ())]
    yield from (f"its exercises have no check {id}" for id in sorted(set(told) - made))
    yield from (f"the check {id} is listed more than once" for id in sorted({id for id in told if told.count(id) > 1}))


def _toml(value: Any) -> str:
    """Strings, and lists of them, of TOML are those of JSON, but for DEL."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
