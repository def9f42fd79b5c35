"""Grades in polhode's own CSV and JSON files."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

from service.formats.grade_row import GradeRow, moment, total_percent
from service.formats.spreadsheet_csv import BYTE_ORDER_MARK, Value, table

PERSON = ("student", "full_name", "email", "student_id")
GRADE = (
    "points",
    "max_points",
    "percent",
    "late",
    "submitted_at",
    "graded_at",
    "attempts",
    "overridden",
    "grader",
    "submission",
)
MORE = ("status", "score", "counted", "penalty", "final")
JSON_FIELDS = (
    "student", "full_name", "email", "student_id", "status", "attempts", "submission", "late", "score",
    "points", "counted",
    "percent", "overridden", "penalty", "final",
)  # fmt: skip


def assignment_csv(rows: Sequence[GradeRow], checks: Sequence[str]) -> str:
    """Return one assignment's grades as CSV: one line per student, with one column per check id.

    A check's cell holds its state, followed by "(override)" where a grader overrode it.
    """
    lines = [[*_grade(row), *_states(row, checks)] for row in rows]
    return BYTE_ORDER_MARK + table([*PERSON, *GRADE, *MORE, *checks], lines)


def course_csv(rows: Sequence[GradeRow]) -> str:
    """Return the course's grades as CSV: one line per student, with points, maximum points and final points
    (after the late penalty) of every assignment, and the weighted total in percent, in which ungraded
    assignments count 0.

    ``rows`` holds the rows of all assignments.
    """
    slugs = list(dict.fromkeys(row.assignment for row in rows))
    header = [
        *PERSON,
        *(f"{slug} {what}" for slug in slugs for what in ("points", "max_points", "final")),
        "total_percent",
    ]
    by_student: dict[str, dict[str, GradeRow]] = {}
    for row in rows:
        by_student.setdefault(row.student, {})[row.assignment] = row
    lines = []
    for of in by_student.values():
        found = [
            (of[slug].points, of[slug].max_points, of[slug].final) if slug in of else (None, None, None)
            for slug in slugs
        ]
        lines.append(
            [
                *_person(next(iter(of.values()))),
                *(value for three in found for value in three),
                total_percent(of.values()),
            ]
        )
    return BYTE_ORDER_MARK + table(header, lines)


def assignment_json(about: Mapping[str, Any], rows: Sequence[GradeRow]) -> str:
    """Return one assignment's grades as a JSON document: the fields of ``about`` and the list ``students``.

    Missing values are null. Texts are not escaped for spreadsheets.
    """
    return json.dumps(
        {**about, "students": [_student(row) for row in rows]}, ensure_ascii=False, allow_nan=False
    )


def _person(row: GradeRow) -> list[Value]:
    return [row.student, row.full_name, row.email, row.student_id]


def _grade(row: GradeRow) -> list[Value]:
    points: list[Value] = [
        row.points,
        row.max_points,
        row.percent,
        row.late,
        moment(row.submitted_at),
        moment(row.graded_at),
    ]
    overridden = row.overridden if row.submission else None
    more = [row.status, row.score, row.counted, row.penalty if row.points is not None else None, row.final]
    return [*_person(row), *points, row.attempts, overridden, row.grader, row.submission, *more]


def _states(row: GradeRow, checks: Sequence[str]) -> list[Value]:
    states = {check: row.state(check) for check in checks}
    return [
        f"{state} (override)" if state and check in row.given else state for check, state in states.items()
    ]


def _student(row: GradeRow) -> dict[str, Any]:
    times = {"submitted_at": moment(row.submitted_at), "graded_at": moment(row.graded_at)}
    checks = {
        check: {
            "state": state,
            "given": row.given.get(check),
            "points": row.worth[check],
            "earned": row.earned[check],
        }
        for check, state in row.checks.items()
    }
    return (
        {name: getattr(row, name) for name in JSON_FIELDS}
        | times
        | {"grader": row.grader or None, "checks": checks}
    )
