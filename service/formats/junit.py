"""JUnit XML for CI systems: a suite for each file and exercise, a case for each check.

JUnit XML has no single standard. This module writes what Jenkins' schema junit-10 allows, plus ``file`` and
``line`` on each case for GitLab and GitHub actions. A ✗ is a ``failure``. A – is an ``error``, like a file
that was not graded: readers count an error as not passed, and those that distinguish the two use it for a
missing result. A check that does not count is ``skipped``. All details are in the element's text, because
GitLab ignores messages; system-out stays empty, because GitLab looks for paths in it.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from exercises.authoring.assignments.assignment import Assignment
from polhode.judging.outcome import Outcome
from polhode.judging.verdict import Verdict
from polhode.report.report import Report
from service.formats.check_text import NOTHING, SUBMITTED, detail, one_line, sanitize
from service.formats.source_lines import SourceLines
from service.grading.graded_file import GradedFile, state

DECLARATION = '<?xml version="1.0" encoding="UTF-8"?>\n'
KINDS = {Verdict.FAIL: "failure", Verdict.UNMEASURED: "error"}


@dataclass(frozen=True)
class Case:
    """A test case. ``kind`` is failure, error, skipped, or empty for a passed case; ``type`` refines it."""

    name: str
    kind: str = ""
    type: str = ""
    message: str = ""
    text: str = ""
    line: int | None = None


def text(files: Sequence[GradedFile], assignment: Assignment) -> str:
    """Return the XML document of all files."""
    root = Element("testsuites", name="polhode")
    for file in files:
        suites = list(_suites(file, assignment))
        share = file.seconds / sum(len(cases) for _, cases in suites)  # checks are not timed separately
        for name, cases in suites:
            _add(root, file, name, cases, share)
    for count in ("tests", "failures", "errors"):
        root.set(count, str(sum(int(suite.get(count, "0")) for suite in root)))
    root.set("time", f"{sum(file.seconds for file in files):.3f}")
    indent(root)
    return DECLARATION + tostring(root, encoding="unicode") + "\n"


def _suites(file: GradedFile, assignment: Assignment) -> Iterator[tuple[str, list[Case]]]:
    """Yield each suite's name and cases."""
    name, report = one_line(file.file.as_posix()), file.report
    if report is None:
        kind, reason = (
            ("fault", f"system fault: {file.fault}")
            if file.fault is not None
            else ("refused", file.refused or "")
        )
        yield name, [Case(SUBMITTED, "error", kind, one_line(reason), sanitize(reason), 1)]
        return
    lines = SourceLines(file, assignment)
    for exercise in report.exercises:
        if exercise.outcomes:
            title = one_line(f"Exercise {exercise.number}. {exercise.title}")
            yield f"{name}: {title}", [_case(outcome, report, lines) for outcome in exercise.outcomes]
    if not report.max_score:
        yield (
            name,
            [Case(NOTHING, "error", "unmeasured", "no check could be scored", sanitize(report.text()))],
        )


def _case(outcome: Outcome, report: Report, lines: SourceLines) -> Case:
    name = f"{outcome.id}: {one_line(outcome.label)}"  # GitLab merges cases of the same name
    if outcome.verdict is Verdict.PASS and outcome.counted:
        return Case(name, line=lines.line_of(outcome))
    kind = KINDS[outcome.verdict] if outcome.counted else "skipped"
    body = detail(outcome, report)
    return Case(
        name, kind, state(outcome, report.scene_ends), one_line(outcome.line), body, lines.line_of(outcome)
    )


def _add(root: Element, file: GradedFile, name: str, cases: Sequence[Case], seconds: float) -> None:
    """Add a suite to the root element; ``seconds`` is the time of each case."""
    kinds, path = [case.kind for case in cases], one_line(file.file.as_posix())
    counts = {"tests": len(cases), "failures": kinds.count("failure"), "errors": kinds.count("error")}
    counts["skipped"] = kinds.count("skipped")
    suite = SubElement(root, "testsuite", {"name": name} | {key: str(count) for key, count in counts.items()})
    suite.set("time", f"{seconds * len(cases):.3f}")
    suite.set("file", path)
    if report := file.report:
        properties, seed = SubElement(suite, "properties"), report.provenance.seed
        about = {
            "assignment": report.assignment,
            "version": report.version,
            "seed": seed,
            "score": report.score,
        }
        for key, value in (about | {"max_score": report.max_score, "total": report.total}).items():
            SubElement(properties, "property", name=key, value=one_line(str(value)))
    for case in cases:
        element = SubElement(
            suite, "testcase", name=case.name, classname=name, time=f"{seconds:.3f}", file=path
        )
        if case.line is not None:
            element.set("line", str(case.line))
        if case.kind:
            SubElement(element, case.kind, type=case.type, message=case.message).text = case.text
