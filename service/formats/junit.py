"""JUnit XML, as CI systems read it: a suite for each file and exercise, a case for each check.

There is no one standard. This is what Jenkins' schema junit-10 allows, with ``file`` and ``line`` on a case too, which GitLab and
the actions for GitHub read there. ✗ is a ``failure``; – is an ``error``, as is a file that could not be graded, since all of these
readers count an error as not passed, and those that tell the two apart mean by it that no answer came; what does not count is
``skipped``. Everything is in the text, for GitLab does not read messages; nothing is in system-out, where it looks for paths.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from ecp.judge import Verdict
from ecp.outcome import Outcome
from ecp.report import ExerciseReport, Report
from exercises.assignment import Assignment
from service.formats.check_text import NOTHING, SUBMITTED, detail, one_line, sanitize
from service.formats.source_lines import Lines
from service.grading.result import GradedFile, state

DECLARATION = '<?xml version="1.0" encoding="UTF-8"?>\n'
KINDS = {Verdict.FAIL: "failure", Verdict.UNMEASURED: "error"}


@dataclass(frozen=True)
class Case:
    """A test case: a passed one has no ``kind``, others are a failure, an error or skipped, of a ``type``."""

    name: str
    kind: str = ""
    type: str = ""
    message: str = ""
    text: str = ""
    line: int | None = None


def text(files: Sequence[GradedFile], assignment: Assignment) -> str:
    """The document of all files."""
    root = Element("testsuites", name="polhode")
    for file in files:
        suites = list(_suites(file, assignment))
        share = file.seconds / sum(len(cases) for _, cases in suites)  # a check has no time of its own
        for name, cases in suites:
            _add(root, file, name, cases, share)
    for count in ("tests", "failures", "errors"):
        root.set(count, str(sum(int(suite.get(count, "0")) for suite in root)))
    root.set("time", f"{sum(file.seconds for file in files):.3f}")
    indent(root)
    return DECLARATION + tostring(root, encoding="unicode") + "\n"


def _suites(file: GradedFile, assignment: Assignment) -> Iterator[tuple[str, list[Case]]]:
    """Names of suites and their cases."""
    name, report = one_line(file.file.as_posix()), file.report
    if report is None:
        yield name, [_ungraded(file)]
        return
    lines = Lines(file, assignment)
    for exercise in report.exercises:
        if exercise.outcomes:
            yield f"{name}: {_title(exercise)}", [_case(outcome, report, lines) for outcome in exercise.outcomes]
    if not report.max_score:
        yield name, [Case(NOTHING, "error", "unmeasured", "nothing that counts was checked", sanitize(report.text()))]


def _ungraded(file: GradedFile) -> Case:
    kind, said = ("fault", f"polhode failed: {file.fault}") if file.fault is not None else ("refused", file.refused or "")
    return Case(SUBMITTED, "error", kind, one_line(said), sanitize(said), 1)


def _case(outcome: Outcome, report: Report, lines: Lines) -> Case:
    name = f"{outcome.id}: {one_line(outcome.label)}"  # two of one name would be one to GitLab
    if outcome.verdict is Verdict.PASS:
        return Case(name, line=lines.of(outcome))
    kind = KINDS[outcome.verdict] if outcome.counted else "skipped"
    told = detail(outcome, report)
    return Case(name, kind, state(outcome, report.scene_ends), one_line(outcome.line), told, lines.of(outcome))


def _title(exercise: ExerciseReport) -> str:
    return one_line(f"Exercise {exercise.number}. {exercise.title}")


def _add(root: Element, file: GradedFile, name: str, cases: Sequence[Case], seconds: float) -> None:
    """A suite under the root; each of its cases took so many ``seconds``."""
    kinds, path = [case.kind for case in cases], one_line(file.file.as_posix())
    counts = {"tests": len(cases), "failures": kinds.count("failure"), "errors": kinds.count("error")}
    counts["skipped"] = kinds.count("skipped")
    suite = SubElement(root, "testsuite", {"name": name} | {key: str(count) for key, count in counts.items()})
    suite.set("time", f"{seconds * len(cases):.3f}")
    suite.set("file", path)
    if file.report is not None:
        properties = SubElement(suite, "properties")
        for key, value in _facts(file.report).items():
            SubElement(properties, "property", name=key, value=one_line(str(value)))
    for case in cases:
        element = SubElement(suite, "testcase", name=case.name, classname=name, time=f"{seconds:.3f}", file=path)
        if case.line is not None:
            element.set("line", str(case.line))
        if case.kind:
            SubElement(element, case.kind, type=case.type, message=case.message).text = case.text


def _facts(report: Report) -> dict[str, object]:
    """What holds for the whole file."""
    made = {"assignment": report.assignment, "version": report.version, "seed": report.provenance.seed}
    return made | {"score": report.score, "max_score": report.max_score, "total": report.most}
