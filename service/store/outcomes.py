"""The outcomes of a result one by one, as a class is looked at by check: written with the result, never altered."""

from typing import Any
from uuid import UUID

from ecp.report import Report
from service.grading.states import state


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
