"""A report without the details of hidden checks, and without what only hidden scenes show."""

from collections.abc import Collection
from dataclasses import replace
from typing import Any

from exercises.authoring.assignments.assignment import Assignment
from polhode.judging.outcome import Outcome
from polhode.judging.verdict import Verdict
from polhode.report.report import Report, pictures

LATER = "the details of this check have not been released yet"


def without_details(report: Report, assignment: Assignment | None) -> Report:
    """Return the report with no more of hidden checks than verdicts and points, and with nothing that their
    scenes returned or that was concluded from it. Without its ``assignment``, every scene counts as hidden.
    """
    scenes, exercises = (assignment.scenes, assignment.exercises) if assignment else ((), ())
    public = {scene.name for scene in scenes if not callable(scene.inputs)}
    figures, animations = pictures(exercises, public)
    shown = {picture.name for picture in (*figures, *animations)}
    kept = [replace(e, outcomes=[_without_hidden(o, public) for o in e.outcomes]) for e in report.exercises]
    stated = {d.sentence for e in kept for o in e.outcomes for d in o.diagnosis}
    return replace(
        report,
        exercises=kept,
        provenance=replace(report.provenance, seed=0, chains={}),
        figures=[one for one in report.figures if one.name in shown],
        animations=[one for one in report.animations if one.name in shown],
        scene_ends=[end for end in report.scene_ends if end.scene in public],
        suspect_lines=[line for line in report.suspect_lines if line.about in stated],
        stdout="",
        sweep=None,
    )


def _without_hidden(outcome: Outcome, public: Collection[str]) -> Outcome:
    """Return the outcome without details if it is hidden or was not measured because of a hidden scene, else
    with those diagnoses that ``public`` scenes alone show.
    """
    if outcome.hidden or (outcome.cause_scene is not None and outcome.cause_scene not in public):
        remarks = [] if outcome.verdict is Verdict.PASS else [LATER]
        numbers: dict[str, Any] = dict.fromkeys(("measured", "expected", "margin", "where", "cause"))
        return replace(outcome, detail="", diagnosis=[], hints=[], remarks=remarks, **numbers)
    kept = [one for one in outcome.diagnosis if one.scenes and set(one.scenes) <= set(public)]
    return replace(outcome, diagnosis=kept)
