"""What became of a check, in more kinds than the three verdicts: how the code stopped where nothing was measured."""

from collections.abc import Iterable

from ecp.judge import Verdict
from ecp.outcome import Ending, Outcome, SceneEnding

MARKS = {"pass": "✓", "fail": "✗", "timeout": "⏱", "error": "!", "unmeasured": "–"}
"""The states of a check, each with its shape."""
WORDS = {"pass": "passed", "fail": "failed", "timeout": "timed out", "error": "stopped by an error", "unmeasured": "not measured"}
NEVER_BEGUN = (Ending.FINISHED, Ending.NOT_PLAYED, Ending.MISSING)


def state(outcome: Outcome, endings: Iterable[SceneEnding]) -> str:
    """Its verdict; where nothing was measured, a key of MARKS that tells how the code stopped."""
    if outcome.verdict is not Verdict.UNMEASURED:
        return outcome.verdict.value
    ending = next((e.ending for e in endings if e.sentence == outcome.cause), Ending.NOT_PLAYED)
    if ending is Ending.TIMED_OUT:
        return "timeout"
    return "unmeasured" if ending in NEVER_BEGUN else "error"
