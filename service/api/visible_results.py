"""What of a graded submission a person may see: before their release, students get no scores, or no details
of hidden checks.
"""

from dataclasses import replace
from typing import Any

from exercises.authoring.assignments.catalogue import assignments
from service.auth.identity import STAFF, Person
from service.grading.author_errors import FAULT
from service.grading.withholding import without_details
from service.store.database import Row
from service.store.submissions.records import SubmissionRecord

NOT_RELEASED = "the scores of this assignment have not been released yet: look again later"
SCORES: dict[str, Any] = {
    "score": None,
    "max_score": None,
    "total": None,
    "points": None,
    "final": None,
    "penalty": 0,
    "overridden": False,
}


def visible(person: Person, stored: SubmissionRecord) -> SubmissionRecord:
    """Return the submission as the person may see it: all of it for the staff, what is released for a
    student, to whom it also does not say where an assignment's own code failed.
    """
    if person.role in STAFF:
        return stored
    if FAULT.format(slug=stored.assignment, error="") in (stored.fault or ""):
        stored = replace(
            stored, fault=FAULT.format(slug=stored.assignment, error="the course staff can see where")
        )
    if not stored.scores_released:
        return replace(stored, report=None, points=None, penalty=0.0, withheld=True)
    if stored.report is not None and not stored.details_released:
        return replace(
            stored, report=without_details(stored.report, assignments().get(stored.report.assignment))
        )
    return stored


def visible_row(person: Person, row: Row) -> Row:
    """Return a row of a list of submissions, without its scores if the person may not see them."""
    if person.role in STAFF or row.scores_released:
        return row
    return row._replace(**{name: value for name, value in SCORES.items() if name in row._fields})
