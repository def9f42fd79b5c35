"""Workflow commands of GitHub Actions: what a step prints and the runner takes for more than text.

The rules are those of the runner's parser (actions/runner, ActionCommand) and of the toolkit that writes commands (actions/toolkit,
core/command): a line is a command if after blanks it begins with ::, or holds ##[ anywhere.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest

from ecp.judge import MARKS, Verdict
from ecp.outcome import Outcome
from ecp.report import Report
from exercises.assignment import Assignment
from service.formats.check_text import NOTHING, block, code, detail, escaped, one_line, sanitize
from service.formats.source_lines import Lines
from service.grading import result as graded
from service.grading.result import GradedFile


@dataclass(frozen=True)
class Annotation:
    """An error at a line of a file, or at none of them."""

    title: str
    message: str
    file: str | None = None
    line: int | None = None

    def __str__(self) -> str:
        """As a workflow command, of one line."""
        about = {"file": self.file, "line": self.line, "title": self.title}
        told = ",".join(f"{key}={_property(str(value))}" for key, value in about.items() if value is not None)
        return f"::error {told}::{_data(self.message)}"


def escape_commands(text: str, token: str) -> str:
    """The text for a workflow's log, in which the runner takes no line for a command; nobody may know the ``token`` before."""
    return f"::stop-commands::{token}\n{text}\n::{token}::"


def _data(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")


MOST = 10
"""Errors of a step that GitHub shows."""
MOST_MESSAGE = 4000
MOST_NAMED = 12
MOST_BYTES = 1 << 20
"""Of a summary: a larger one is not shown at all."""
MOST_OF_ONE = 64 << 10
ROOM = 1024
HEADER = "| file | | points | likeliest cause |\n|---|---|---|---|\n"


def annotations(files: Sequence[GradedFile], assignment: Assignment) -> Iterator[str]:
    """At most MOST commands: what did not pass, checks of one function and one cause together, first each file's largest group."""
    by_file = [_of(file, assignment) for file in files]
    found = [one for rank in zip_longest(*by_file) for one in rank if one is not None]
    first = found if len(found) <= MOST else found[: MOST - 1]
    yield from map(str, first)
    if left := len(found) - len(first):
        yield str(Annotation("polhode", f"and {left} more: GitHub shows {MOST} for a step, the report has them all"))


def summary(files: Sequence[GradedFile], assignment: Assignment, most: int = MOST_BYTES) -> str:
    """A table of the files, then the lines, causes and figures' captions of each, first of those that did not pass, while ``most``
    bytes have room."""
    head = f"## polhode: {escaped(assignment.title)}\n\n{escaped(graded.summary(files))}\n\n{HEADER}"
    table, left = _fitting(files, _row, most // 2 - len(head.encode()))
    table += f"\n{left} more files have no row here.\n" * bool(left)
    room = most - len((head + table).encode()) - ROOM
    details, left = _fitting(sorted(files, key=lambda file: file.passed), _details, room)
    return head + table + "\n" + details + f"\nThere is no room here for the lines of {left} more files.\n" * bool(left)


def _of(file: GradedFile, assignment: Assignment) -> list[Annotation]:
    path = one_line(file.file.as_posix())
    if file.fault is not None:
        return [Annotation("polhode failed: this is no verdict", sanitize(file.fault, MOST_MESSAGE), path, 1)]
    if file.report is None:
        return [Annotation("no submission", sanitize(file.refused or "", MOST_MESSAGE), path, 1)]
    if not file.report.max_score:
        return [Annotation(f"not so: {NOTHING}", sanitize(file.report.text(), MOST_MESSAGE), path, 1)]
    lines = Lines(file, assignment)
    groups: dict[tuple[int | None, str], list[tuple[str, Outcome]]] = {}
    for exercise in file.report.exercises:
        for outcome in exercise.outcomes:
            if outcome.counted and outcome.verdict is not Verdict.PASS:
                groups.setdefault((lines.of(outcome), _cause(outcome)), []).append((exercise.number, outcome))
    largest_first = sorted(groups.items(), key=lambda group: -len(group[1]))
    return [_annotation(file, path, line, outcomes, lines) for (line, _), outcomes in largest_first]


def _cause(outcome: Outcome) -> str:
    return next((cause.sentence for cause in outcome.diagnosis), outcome.cause or "")


def _annotation(file: GradedFile, path: str, line: int | None, outcomes: list[tuple[str, Outcome]], lines: Lines) -> Annotation:
    """One for several checks: the first with all that is known of it, the others by their labels."""
    assert file.report is not None
    (exercise, first), others = outcomes[0], [outcome.line for _, outcome in outcomes[1:]]
    told = [detail(first, file.report, trace=False)]
    if others:
        left = [f"and {len(others) - MOST_NAMED} more"] if len(others) > MOST_NAMED else []
        told += ["", f"also {len(others)} more check{'s' * (len(others) > 1)}:", *others[:MOST_NAMED], *left]
    where = ": ".join(part for part in (f"exercise {exercise}", lines.function(first)) if part)
    many = f" ({len(outcomes)} checks)" if others else ""
    return Annotation(one_line(where + many), sanitize("\n".join(told), MOST_MESSAGE), path, line)


def _fitting(files: Sequence[GradedFile], told: Callable[[GradedFile], str], room: int) -> tuple[str, int]:
    """What is ``told`` of as many files in turn as have room (bytes of UTF-8), and how many are left."""
    parts: list[str] = []
    for file in files:
        part = told(file)
        if (room := room - len(part.encode())) < 0:
            break
        parts.append(part)
    return "".join(parts), len(files) - len(parts)


def _row(file: GradedFile) -> str:
    name, report = code(file.file.as_posix()[-200:]), file.report
    if report is None:
        mark, told = ("!", "polhode failed") if file.fault is not None else (MARKS[Verdict.UNMEASURED], "no submission")
        return f"| {name} | {mark} | {told} | |\n"
    mark = MARKS[Verdict.PASS if report.passed else Verdict.FAIL]
    return f"| {name} | {mark} | {report.score} of {report.most} | {_likeliest(report)} |\n"


def _likeliest(report: Report) -> str:
    """The cause of most checks that did not pass, by its code."""
    wrong = [outcome for outcome in report.outcomes() if outcome.counted and outcome.verdict is not Verdict.PASS]
    found = Counter(cause.code for outcome in wrong for cause in outcome.diagnosis)
    return code(found.most_common(1)[0][0]) if found else ""


def _details(file: GradedFile) -> str:
    """What there is to say of one file, folded."""
    report = file.report
    said = report.text() if report else (file.fault if file.fault is not None else file.refused) or ""
    told = f"{block(said[:MOST_OF_ONE])}\n"
    if report and (pictures := [*report.figures, *report.animations]):
        told += "\n" + "".join(f"- **{escaped(picture.title)}**: {escaped(picture.alt)}\n" for picture in pictures)
    of = report.summary() if report else ("polhode failed" if file.fault is not None else "no submission")
    return f"<details><summary>{code(file.file.as_posix()[-200:])}: {escaped(of)}</summary>\n\n{told}\n</details>\n\n"
