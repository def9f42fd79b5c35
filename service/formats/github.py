"""Annotations and job summaries for GitHub Actions.

A line is a workflow command if it starts with :: after blanks, or contains ##[ anywhere. The escaping follows
the runner's parser (actions/runner, ActionCommand) and the toolkit (actions/toolkit, core/command).
"""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest

from exercises.authoring.assignments.assignment import Assignment
from polhode.judging.outcome import Outcome
from polhode.judging.verdict import MARKS, Verdict
from service.formats.check_text import NOTHING, block, code, detail, escaped, one_line, sanitize
from service.formats.source_lines import SourceLines
from service.grading import graded_file
from service.grading.graded_file import GradedFile


@dataclass(frozen=True)
class Annotation:
    """An error annotation, attached to a line of a file or to none."""

    title: str
    message: str
    file: str | None = None
    line: int | None = None

    def __str__(self) -> str:
        """Return the annotation as a one-line workflow command."""
        about = {"file": self.file, "line": self.line, "title": self.title}
        given = {key: _data(str(value)) for key, value in about.items() if value is not None}
        properties = ",".join(
            f"{key}={text.replace(':', '%3A').replace(',', '%2C')}" for key, text in given.items()
        )
        return f"::error {properties}::{_data(self.message)}"


def escape_commands(text: str, token: str) -> str:
    """Return the text wrapped so that the runner reads no line of it as a command. ``token`` must be
    unpredictable.
    """
    return f"::stop-commands::{token}\n{text}\n::{token}::"


def _data(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


MOST = 10
"""GitHub shows at most this many errors of a step."""
MOST_MESSAGE = 4000
MOST_NAMED = 12
MOST_BYTES = 1 << 20
"""GitHub rejects a larger summary."""
MOST_OF_ONE = 64 << 10
ROOM = 1024
HEADER = "| file | | points | most likely cause |\n|---|---|---|---|\n"


def annotations(files: Sequence[GradedFile], assignment: Assignment) -> Iterator[str]:
    """Yield at most MOST workflow commands for what did not pass.

    One annotation groups the checks of one function with the same cause. The largest group of each file comes
    first.
    """
    by_file = [_file_annotations(file, assignment) for file in files]
    found = [one for rank in zip_longest(*by_file) for one in rank if one is not None]
    first = found if len(found) <= MOST else found[: MOST - 1]
    yield from map(str, first)
    if left := len(found) - len(first):
        yield str(
            Annotation(
                "polhode", f"and {left} more: GitHub shows {MOST} per step, the report lists all of them"
            )
        )


def summary(files: Sequence[GradedFile], assignment: Assignment, most: int = MOST_BYTES) -> str:
    """Return a Markdown summary: a table of the files, then each file's report and figure captions, failed
    files first.

    The summary has at most ``most`` bytes; files that do not fit are counted.
    """
    head = f"## polhode: {escaped(assignment.title)}\n\n{escaped(graded_file.summary(files))}\n\n{HEADER}"
    table, left = _fitting(files, _row, most // 2 - len(head.encode()))
    table += f"\n{left} more files are not listed.\n" * bool(left)
    room = most - len((head + table).encode()) - ROOM
    details, left = _fitting(sorted(files, key=lambda file: file.passed), _details, room)
    return (
        head + table + "\n" + details + f"\nThe reports of {left} more files do not fit here.\n" * bool(left)
    )


def _file_annotations(file: GradedFile, assignment: Assignment) -> list[Annotation]:
    path = one_line(file.file.as_posix())
    if file.fault is not None:
        return [Annotation("system fault: not graded", sanitize(file.fault, MOST_MESSAGE), path, 1)]
    if file.report is None:
        return [Annotation("no submission", sanitize(file.refused or "", MOST_MESSAGE), path, 1)]
    if not file.report.max_score:
        return [Annotation(f"failed: {NOTHING}", sanitize(file.report.text(), MOST_MESSAGE), path, 1)]
    lines = SourceLines(file, assignment)
    groups: dict[tuple[int | None, str], list[tuple[str, Outcome]]] = {}
    for exercise in file.report.exercises:
        for outcome in exercise.outcomes:
            if outcome.counted and outcome.verdict is not Verdict.PASS:
                cause = next((cause.sentence for cause in outcome.diagnosis), outcome.cause or "")
                groups.setdefault((lines.line_of(outcome), cause), []).append((exercise.number, outcome))
    largest_first = sorted(groups.items(), key=lambda group: -len(group[1]))
    return [_annotation(file, path, line, outcomes, lines) for (line, _), outcomes in largest_first]


def _annotation(
    file: GradedFile, path: str, line: int | None, outcomes: list[tuple[str, Outcome]], lines: SourceLines
) -> Annotation:
    """Return one annotation for several checks: the first in detail, the others by their lines."""
    assert file.report is not None
    (exercise, first), others = outcomes[0], [outcome.line for _, outcome in outcomes[1:]]
    lines_of = [detail(first, file.report, trace=False)]
    if others:
        left = [f"and {len(others) - MOST_NAMED} more"] if len(others) > MOST_NAMED else []
        lines_of += [
            "",
            f"also {len(others)} more check{'s' * (len(others) > 1)}:",
            *others[:MOST_NAMED],
            *left,
        ]
    where = ": ".join(part for part in (f"exercise {exercise}", lines.function(first)) if part)
    many = f" ({len(outcomes)} checks)" if others else ""
    return Annotation(one_line(where + many), sanitize("\n".join(lines_of), MOST_MESSAGE), path, line)


def _fitting(files: Sequence[GradedFile], render: Callable[[GradedFile], str], room: int) -> tuple[str, int]:
    """Render files in turn while they fit into ``room`` bytes of UTF-8. Return the text and the number of
    files left out.
    """
    parts: list[str] = []
    for file in files:
        part = render(file)
        if (room := room - len(part.encode())) < 0:
            break
        parts.append(part)
    return "".join(parts), len(files) - len(parts)


def _row(file: GradedFile) -> str:
    name, report = code(file.file.as_posix()[-200:]), file.report
    if report is None:
        mark, why = (
            ("!", "system fault") if file.fault is not None else (MARKS[Verdict.UNMEASURED], "no submission")
        )
        return f"| {name} | {mark} | {why} | |\n"
    mark = MARKS[Verdict.PASS if report.passed else Verdict.FAIL]
    wrong = [
        outcome for outcome in report.outcomes() if outcome.counted and outcome.verdict is not Verdict.PASS
    ]
    found = Counter(cause.code for outcome in wrong for cause in outcome.diagnosis)
    most_common = code(found.most_common(1)[0][0]) if found else ""
    return f"| {name} | {mark} | {report.score} of {report.out_of} | {most_common} |\n"


def _details(file: GradedFile) -> str:
    """Return the report of one file, folded."""
    report = file.report
    printed = report.text() if report else (file.fault if file.fault is not None else file.refused) or ""
    body = f"{block(printed[:MOST_OF_ONE])}\n"
    if report and (pictures := [*report.figures, *report.animations]):
        body += "\n" + "".join(
            f"- **{escaped(picture.title)}**: {escaped(picture.alt)}\n" for picture in pictures
        )
    of = report.summary() if report else ("system fault" if file.fault is not None else "no submission")
    return (
        f"<details><summary>{code(file.file.as_posix()[-200:])}: {escaped(of)}</summary>\n\n"
        f"{body}\n</details>\n\n"
    )
