"""Classroom 50's result.json, ``classroom50/result/v1``: points are whole numbers, and what does not count is no test.

Its runner stamps ``owner``, ``assignment_type``, ``datetime`` and ``graded_at`` over ours, and by them files the grade.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

from ecp.judge import Verdict
from ecp.report import ExerciseReport, Report
from exercises.assignment import Assignment
from service.formats.check_text import NOTHING, SUBMITTED, NoVerdict, detail, not_attempted, one_line, sanitize
from service.grading.result import GradedFile, state

SCHEMA = "classroom50/result/v1"


@dataclass(frozen=True, kw_only=True)
class About:
    """Whose submission it is, and where: ``classroom`` and ``assignment`` are the names that Classroom 50 has for them.

    ``assignment_type`` is individual, group or team, ``submission`` the tag submit/TIME-COMMIT, ``commit``, ``release`` and
    ``review`` are addresses. ``submitted_at`` is the same in every regrade, ``graded_at`` moves.
    """

    classroom: str
    assignment: str
    assignment_type: str
    owner: str
    submission: str
    commit: str
    release: str
    review: str
    submitted_at: datetime
    graded_at: datetime | None = None


def document(file: GradedFile, assignment: Assignment, about: About) -> dict[str, Any]:
    """The document of one file; NoVerdict for a fault of ours."""
    if file.fault is not None:
        raise NoVerdict(file.fault)
    if (report := file.report) is None:
        most, tests = assignment.max_points(), [_failed(SUBMITTED, assignment.max_points(), file.refused or "")]
    elif not report.max_score:
        most, tests = 0, [_failed(NOTHING, 0, "nothing that counts was checked")]
    else:
        missed = not_attempted(report, assignment)
        most, tests = report.max_score + sum(missed.values()), [t for e in report.exercises for t in _tests(e, report)]
        tests += [_failed(name, points, name) for name, points in missed.items()]
    return {"schema": SCHEMA, **_told(about), "score": file.points, "max-score": most, "tests": tests}


def moment(at: datetime) -> str:
    """A moment as the schema has it: UTC, to the second."""
    return at.astimezone(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


def _told(about: About) -> dict[str, str]:
    times = {"datetime": moment(about.submitted_at)} | ({"graded_at": moment(about.graded_at)} if about.graded_at else {})
    return {key: value for key, value in vars(about).items() if isinstance(value, str)} | times


def _tests(exercise: ExerciseReport, report: Report) -> Iterator[dict[str, Any]]:
    for outcome in exercise.outcomes:
        if outcome.counted:
            passed = outcome.verdict is Verdict.PASS
            name = one_line(f"{exercise.number}. {outcome.label}")
            yield {
                "test-name": name,
                "passed": passed,
                "score": int(passed),
                "max-score": 1,
                "id": outcome.id,
                "verdict": outcome.verdict.value,
                "state": state(outcome, report.scene_ends),
                "output": detail(outcome, report),
            }


def _failed(name: str, most: int, output: str) -> dict[str, Any]:
    return {"test-name": name, "passed": False, "score": 0, "max-score": most, "output": sanitize(output)}
