"""What a telling says of one check: text that is harmless wherever it is shown, with all that helps to find the discrepancy."""

import re
from collections.abc import Iterable

from ecp.judge import Verdict
from ecp.outcome import Outcome, SceneEnd
from ecp.report import Report
from exercises.assignment import Assignment
from service.sandbox.wire import text

NOTHING = "a check that counts was made"
"""Its failure stands where nothing that counts was checked: other systems take no failure for a success."""
SUBMITTED = "the file can be graded"
MOST_TRACE = 2000


class NoVerdict(Exception):
    """We could not grade the file, and a grade would be a lie."""


def sanitize(told: str, most: int | None = None) -> str:
    """The text without what is no character of XML, turns lines around or steers a terminal; cut to ``most`` characters."""
    whole = text(told.replace("\r\n", "\n"), len(told))
    return whole if most is None or len(whole) <= most else f"{whole[: most - 2]} …"


def one_line(told: str, most: int | None = None) -> str:
    """The same as one line."""
    return sanitize(" ".join(told.split()), most)


def detail(outcome: Outcome, report: Report, *, trace: bool = True) -> str:
    """The check's line, where a ✗ is worst, likely causes, hints, why just so much was allowed; then the code that stopped."""
    parts = [outcome.text()]
    if outcome.verdict is Verdict.FAIL:
        parts.append(f"     allowed: {outcome.tolerance.reason}")
    scene_end = stopped_by(outcome, report.scene_ends) if trace else None
    if scene_end and scene_end.traceback:
        parts.append(f"{scene_end.scene}: {scene_end.sentence}\n{scene_end.traceback[-MOST_TRACE:].rstrip()}")
    return sanitize("\n".join(parts))


def not_attempted(report: Report, assignment: Assignment) -> dict[str, int]:
    """Return the points of each exercise that was asked for and not attempted, by a sentence that says so."""
    there = {exercise.number for exercise in assignment.exercises}
    points = {number: assignment.max_points([number]) for number in report.not_attempted if number in there}
    return {f"exercise {number} was not attempted": most for number, most in points.items() if most}


def stopped_by(outcome: Outcome, scene_ends: Iterable[SceneEnd]) -> SceneEnd | None:
    """The ending with a traceback that kept the check from being measured."""
    if outcome.verdict is not Verdict.UNMEASURED:
        return None
    told = {outcome.cause, *(cause.sentence for cause in outcome.diagnosis)}
    return next((e for e in scene_ends if e.traceback and e.sentence in told), None)


_PLAIN = re.compile(r"[^\w ]|_", re.ASCII)


def code(told: str) -> str:
    """In a line, also in a cell of a table: every sign an entity, which Markdown reads as a sign and never as its own."""
    return f"<code>{escaped(told)}</code>"


def escaped(told: str) -> str:
    """The same without being code: for what is ours."""
    return _PLAIN.sub(lambda sign: sign[0] if ord(sign[0]) > 127 else f"&#{ord(sign[0])};", one_line(told))


def block(told: str) -> str:
    """Lines as they are, behind a fence longer than any in them."""
    plain = sanitize(told).rstrip("\n")
    fence = "`" * max(3, 1 + max(map(len, re.findall("`+", plain)), default=0))
    return f"{fence}text\n{plain}\n{fence}"
