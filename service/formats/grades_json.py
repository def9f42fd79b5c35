"""The same as JSON: numbers as numbers, null for what is not there, texts as they are."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

from service.formats.grade_row import GradeRow, moment

AS_THEY_ARE = (
    "student", "full_name", "email", "student_id", "status", "attempts", "submission", "late", "score", "points", "counted",
    "percent", "overridden",
)  # fmt: skip


def text(about: Mapping[str, Any], rows: Sequence[GradeRow]) -> str:
    """``about`` the assignment, and its ``students``."""
    return json.dumps({**about, "students": [_student(row) for row in rows]}, ensure_ascii=False, allow_nan=False)


def _student(row: GradeRow) -> dict[str, Any]:
    times = {"submitted_at": moment(row.submitted_at), "graded_at": moment(row.graded_at)}
    checks = {check: {"state": state, "given": row.given.get(check)} for check, state in row.checks.items()}
    return {name: getattr(row, name) for name in AS_THEY_ARE} | times | {"grader": row.grader or None, "checks": checks}
