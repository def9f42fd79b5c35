"""The text of one check for other systems: harmless wherever it is displayed, with what helps to find the
error.
"""

import re
from collections.abc import Iterable

from exercises.authoring.assignments.assignment import Assignment
from polhode.judging.outcome import Outcome, SceneEnd
from polhode.judging.verdict import Verdict
from polhode.report.report import Report
from service.sandbox.untrusted_text import text

NOTHING = "at least one check was scored"
"""Name of a failed test for reports without counted checks, since other systems read "no failure" as success.
"""
SUBMITTED = "the file can be graded"
MOST_TRACE = 2000


class NoVerdict(Exception):
    """The file was not graded because of a system fault, so no grade may be written."""


def sanitize(raw: str, most: int | None = None) -> str:
    """Return the text without non-XML characters, bidirectional controls and terminal sequences, cut to
    ``most`` characters.
    """
    whole = text(raw.replace("\r\n", "\n"), len(raw))
    return whole if most is None or len(whole) <= most else f"{whole[: most - 2]} …"


def one_line(raw: str, most: int | None = None) -> str:
    """Return the sanitized text on one line, cut to ``most`` characters."""
    return sanitize(" ".join(raw.split()), most)


def detail(outcome: Outcome, report: Report, *, trace: bool = True) -> str:
    """Return all that is known about a check: its line, location, diagnosis and hints, the reason for its
    tolerance, and the traceback that prevented the measurement.
    """
    parts = [outcome.text()]
    if outcome.verdict is Verdict.FAIL:
        parts.append(f"     allowed: {outcome.tolerance.reason}")
    scene_end = stopped_by(outcome, report.scene_ends) if trace else None
    if scene_end and scene_end.traceback:
        parts.append(f"{scene_end.scene}: {scene_end.sentence}\n{scene_end.traceback[-MOST_TRACE:].rstrip()}")
    return sanitize("\n".join(parts))


def not_attempted(report: Report, assignment: Assignment) -> dict[str, int]:
    """Return the points of each requested exercise that was not attempted,
    keyed by a sentence that says so.
    """
    known = {exercise.number for exercise in assignment.exercises}
    points = {number: assignment.max_points([number]) for number in report.not_attempted if number in known}
    return {f"exercise {number} was not attempted": most for number, most in points.items() if most}


def stopped_by(outcome: Outcome, scene_ends: Iterable[SceneEnd]) -> SceneEnd | None:
    """Return the scene end whose traceback explains why the check is unmeasured, or None."""
    if outcome.verdict is not Verdict.UNMEASURED:
        return None
    reasons = {outcome.cause, *(cause.sentence for cause in outcome.diagnosis)}
    return next((e for e in scene_ends if e.traceback and e.sentence in reasons), None)


_PLAIN = re.compile(r"[^\w ]|_", re.ASCII)


def code(raw: str) -> str:
    """Return the text as inline code for Markdown, on one line, safe in a table cell too. Every punctuation
    mark becomes an entity.
    """
    return f"<code>{escaped(raw)}</code>"


def escaped(raw: str) -> str:
    """Return the text on one line with every ASCII punctuation mark as an entity, so that Markdown renders it
    literally.
    """
    return _PLAIN.sub(lambda sign: sign[0] if ord(sign[0]) > 127 else f"&#{ord(sign[0])};", one_line(raw))


def block(raw: str) -> str:
    """Return the text as a Markdown code block, with a fence longer than any fence in the text."""
    plain = sanitize(raw).rstrip("\n")
    fence = "`" * max(3, 1 + max(map(len, re.findall("`+", plain)), default=0))
    return f"{fence}text\n{plain}\n{fence}"
