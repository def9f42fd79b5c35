"""What of a graded submission a person may see: before their release, students get no scores, or no details
of hidden checks.
"""

from dataclasses import replace
from typing import Any

from ecp.judge import Verdict
from ecp.outcome import Outcome
from ecp.report import Report, pictures
from exercises.catalogue import assignments
from service.auth.identity import STAFF, Person
from service.grading.author_errors import FAULT
from service.store.database import Row
from service.store.records import SubmissionRecord

NOT_RELEASED = "the scores of this assignment have not been released yet: look again later"
LATER = "the details of this check have not been released yet"
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
        return replace(stored, report=_without_details(stored.report))
    return stored


def visible_row(person: Person, row: Row) -> Row:
    """Return a row of a list of submissions, without its scores if the person may not see them."""
    if person.role in STAFF or row.scores_released:
        return row
    return row._replace(**{name: value for name, value in SCORES.items() if name in row._fields})


def _without_details(report: Report) -> Report:
    """Return the report with no more of hidden checks than verdicts and points, and with nothing that their
    scenes returned.
    """
    assignment = assignments().get(report.assignment)
    public = (
        {scene.name for scene in assignment.scenes if not callable(scene.inputs)} if assignment else set()
    )
    exercises = [
        replace(e, outcomes=[_without_numbers(o) if o.hidden else o for o in e.outcomes])
        for e in report.exercises
    ]
    stated = {d.sentence for e in exercises for o in e.outcomes for d in o.diagnosis}
    figures, animations = pictures(assignment.exercises, public) if assignment else ([], [])
    shown = {picture.name for picture in (*figures, *animations)}
    return replace(
        report,
        exercises=exercises,
        provenance=replace(report.provenance, seed=0, chains={}),
        figures=[one for one in report.figures if one.name in shown],
        animations=[one for one in report.animations if one.name in shown],
        scene_ends=[end for end in report.scene_ends if end.scene in public],
        suspect_lines=[line for line in report.suspect_lines if line.about in stated],
        stdout="",
        sweep=None,
    )


def _without_numbers(outcome: Outcome) -> Outcome:
    remarks = [] if outcome.verdict is Verdict.PASS else [LATER]
    numbers: dict[str, Any] = dict.fromkeys(("measured", "expected", "margin", "where", "cause"))
    return replace(outcome, detail="", diagnosis=[], hints=[], remarks=remarks, **numbers)
