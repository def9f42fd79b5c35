"""Classroom 50's result.json, schema ``classroom50/result/v1``: whole points, and no test for a check that
does not count.

Classroom 50's runner overwrites ``owner``, ``assignment_type``, ``datetime`` and ``graded_at`` and files the
grade by them.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from exercises.authoring.assignments.assignment import Assignment
from polhode.judging.outcome import ExerciseReport
from polhode.judging.verdict import Verdict
from polhode.report.report import Report
from service.formats.check_text import (
    NOTHING,
    SUBMITTED,
    NoVerdict,
    detail,
    not_attempted,
    one_line,
    sanitize,
)
from service.formats.grade_row import moment
from service.grading.graded_file import GradedFile, state

SCHEMA = "classroom50/result/v1"


@dataclass(frozen=True, kw_only=True)
class SubmissionInfo:
    """The submission's identity in Classroom 50.

    ``classroom`` and ``assignment`` are Classroom 50's names. ``assignment_type`` is individual, group or
    team. ``submission`` is the tag submit/TIME-COMMIT. ``commit``, ``release`` and ``review`` are URLs.
    ``submitted_at`` stays the same in every regrade, ``graded_at`` does not.
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


def document(file: GradedFile, assignment: Assignment, about: SubmissionInfo) -> dict[str, Any]:
    """Return the result document of one file. Raises NoVerdict after a system fault."""
    if file.fault is not None:
        raise NoVerdict(file.fault)
    if (report := file.report) is None:
        most, tests = (
            assignment.max_points(),
            [_failed(SUBMITTED, assignment.max_points(), file.refused or "")],
        )
    elif not report.max_score:
        most, tests = 0, [_failed(NOTHING, 0, "no check could be scored")]
    else:
        missed = not_attempted(report, assignment)
        most, tests = (
            report.max_score + sum(missed.values()),
            [t for e in report.exercises for t in _tests(e, report)],
        )
        tests += [_failed(name, points, name) for name, points in missed.items()]
    identity: dict[str, str | None] = {
        key: value for key, value in vars(about).items() if isinstance(value, str)
    }
    identity["datetime"] = moment(about.submitted_at)
    if about.graded_at:
        identity["graded_at"] = moment(about.graded_at)
    return {"schema": SCHEMA, **identity, "score": file.points, "max-score": most, "tests": tests}


def _tests(exercise: ExerciseReport, report: Report) -> Iterator[dict[str, Any]]:
    for outcome in exercise.outcomes:
        if outcome.counted:
            passed = outcome.verdict is Verdict.PASS
            name = one_line(f"{exercise.number}. {outcome.label}")
            yield {
                "test-name": name,
                "passed": passed,
                "score": outcome.earned,
                "max-score": outcome.points,
                "id": outcome.id,
                "verdict": outcome.verdict.value,
                "state": state(outcome, report.scene_ends),
                "output": detail(outcome, report),
            }


def _failed(name: str, most: int, output: str) -> dict[str, Any]:
    return {"test-name": name, "passed": False, "score": 0, "max-score": most, "output": sanitize(output)}
