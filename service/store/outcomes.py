"""The outcomes of a result one by one, as a class is looked at by check: written with the result, never altered."""

from collections.abc import Iterable
from typing import Any
from uuid import UUID

from ecp.judge import Verdict
from ecp.outcome import Ending, Outcome, SceneEnding
from ecp.report import Report

MARKS = {"pass": "✓", "fail": "✗", "timeout": "⏱", "error": "!", "unmeasured": "–"}
"""The states of a check in a class's table, each with its shape."""
WORDS = {"pass": "passed", "fail": "failed", "timeout": "timed out", "error": "stopped by an error", "unmeasured": "not measured"}
NEVER_BEGUN = (Ending.FINISHED, Ending.NOT_PLAYED, Ending.MISSING)


def rows(attempt: UUID, report: Report) -> list[dict[str, Any]]:
    """A row of the table ``outcome`` for each check of the report."""
    return [
        {
            "attempt_id": attempt,
            "check_id": outcome.id,
            "state": state(outcome, report.endings),
            "counted": outcome.counted,
            "margin": outcome.margin,
            "codes": [cause.code for cause in outcome.diagnosis],
            "causes": [cause.sentence for cause in outcome.diagnosis],
        }
        for outcome in report.outcomes()
    ]


def state(outcome: Outcome, endings: Iterable[SceneEnding]) -> str:
    """Its verdict; where nothing was measured, a key of MARKS that tells how the code stopped."""
    if outcome.verdict is not Verdict.UNMEASURED:
        return outcome.verdict.value
    ending = next((e.ending for e in endings if e.sentence == outcome.cause), Ending.NOT_PLAYED)
    if ending is Ending.TIMED_OUT:
        return "timeout"
    return "unmeasured" if ending in NEVER_BEGUN else "error"
