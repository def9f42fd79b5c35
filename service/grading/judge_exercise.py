"""Judging what a submission returned by the checks of an exercise."""

import re
from collections.abc import Callable, Mapping
from dataclasses import replace

from exercises.authoring.assignments.assignment import Assignment, Scene
from exercises.authoring.importing.reported_lines import ReportedLine
from polhode.judging.checks import Check
from polhode.judging.exercise import Exercise
from polhode.judging.outcome import Diagnosis, Ended, ExerciseReport, Outcome
from polhode.judging.remarks import Absent, unsaid
from polhode.judging.verdict import Verdict
from service.grading.run_in_sandbox import PlayedJob
from service.sandbox.result import PlayResult

Causes = Callable[[str], list[Diagnosis]]
"""A function that returns the diagnoses of a question's results, given its id."""
NOT_DEFINED = re.compile(r"NameError: name '(\w+)' is not defined")


def judge(
    exercise: Exercise,
    assignment: Assignment,
    played: PlayedJob,
    causes: Causes,
    *,
    remarks: Mapping[str, list[str]],
) -> ExerciseReport:
    """Return the report of an exercise: each check judged by the exact answers, each ✗ and – with its cause.

    ``remarks`` are those on the outcomes of a scene.
    """
    outcomes, result, said = [], played.result, set[str]()
    expected = assignment.expected_checks(exercise)
    for check in exercise.applicable_checks(result.written, assignment.names):
        scenes = [assignment.scene(name) for name in check.scenes]
        outcome = _outcome(check, assignment, scenes, played)
        if absent := _absent(check, scenes, result):
            name, why = absent
            outcome.diagnosis = [Diagnosis(why.code, why.sentence, 1.0, (name,))] if why.code else []
        elif outcome.verdict is not Verdict.PASS:
            outcome.diagnosis = _diagnose(assignment, scenes, result, causes)
        outcome.hidden = assignment.hidden(check)
        outcome.bonus = check not in expected
        outcome.remarks = [remark for name in check.scenes[:1] for remark in remarks.get(name, [])]
        noted = [result.noted(name) for s in scenes for name in (s.name, s.after)]
        outcome.remarks += unsaid(noted, said)
        outcomes.append(outcome)
    return ExerciseReport(number=exercise.number, title=exercise.title, outcomes=outcomes)


def passes(assignment: Assignment, check: Check, played: PlayedJob) -> bool:
    """Return whether a check passes or does not count."""
    scenes = [assignment.scene(name) for name in check.scenes]
    outcome = _outcome(check, assignment, scenes, played)
    return outcome.verdict is Verdict.PASS or not outcome.counted


def _diagnose(
    assignment: Assignment, scenes: list[Scene], result: PlayResult, causes: Causes
) -> list[Diagnosis]:
    """Return the diagnoses of the results of a scene or of the one before it, else one for its scene end."""
    names = [name for scene in scenes for name in (scene.after, scene.name) if name is not None]
    for name in names:
        question = assignment.scene(name).question
        if name in result.arrays and question is not None and (found := causes(question["id"])):
            return list(found)
    for scene_end in map(result.scene_ends.get, names):
        if scene_end is not None and scene_end.code is not None:
            return [Diagnosis(scene_end.code, scene_end.cause, 1.0, (scene_end.scene,))]
    return []


def _outcome(check: Check, assignment: Assignment, scenes: list[Scene], played: PlayedJob) -> Outcome:
    result, truths = played.result, played.truths
    if isinstance(check, ReportedLine):
        claims = result.reported.get((check.cell, check.call.place), ())
        return check.reported(
            claims,
            _cause_of_cell(check, assignment, result),
            stopped=check.cell in result.cells or _is_cut_short(check, result),
            solution=played.claims_of_solution.get((check.cell, check.call.place), 0),
        )
    for scene in scenes:
        if not result.finished(scene.name):
            name, sentence = _cause(scene, result)
            return replace(check.unmeasured(sentence), cause_scene=name)
    if absent := _absent(check, scenes, result):
        name, why = absent
        return replace(check.unmeasured(why.sentence), cause_scene=name)
    return check.judge([result.arrays[s.name] for s in scenes], [truths[s.name] for s in scenes])


def _absent(check: Check, scenes: list[Scene], result: PlayResult) -> tuple[str, Absent] | None:
    """Return a scene of which an array that the check reads is absent, and why. None if none is."""
    for scene in scenes:
        if result.finished(scene.name) and (why := result.noted(scene.name).unread(check.arrays)):
            return scene.name, why
    return None


def _cause(scene: Scene, result: PlayResult) -> tuple[str | None, str]:
    """Return why a scene has no result, by its own scene end or that of the scene it comes after, and the
    name of the scene that ended so; None if its inputs have nothing to do with it.
    """
    scene_end = result.scene_ends.get(scene.name)
    if scene_end is None:
        return None, "your code stopped before this scene was played"
    if (
        scene_end.ended is Ended.NOT_PLAYED
        and scene.after in result.scene_ends
        and not result.finished(scene.after)
    ):
        scene_end = result.scene_ends[scene.after]
    return None if scene_end.ended is Ended.MISSING else scene_end.scene, scene_end.sentence


def _cause_of_cell(check: ReportedLine, assignment: Assignment, result: PlayResult) -> str:
    """Return why a published cell did not reach a line, or not as often as its loop would."""
    if check.cell in result.cells:
        sentence = result.cells[check.cell].sentence
        return f"the validation cell stopped with {sentence}{_where_to_define(sentence, assignment)}"
    if _is_cut_short(check, result):
        return "another line of its loop is ✗, which ends the loop"
    return "the cell did not reach this line, or your code stopped before"


def _where_to_define(sentence: str, assignment: Assignment) -> str:
    """Return which exercise asks for the name that the sentence of a NameError says is missing, or ""."""
    name = found[1] if (found := NOT_DEFINED.fullmatch(sentence)) else ""
    number = next((one.number for one in assignment.exercises if name in one.functions), "")
    return f": define it in exercise {number}, above its validation" if number else ""


def _is_cut_short(check: ReportedLine, result: PlayResult) -> bool:
    """Return whether the strict ✗ of another line ended the loop of this one."""
    if not check.call.loop:
        return False
    first, last = check.call.loop
    return any(
        cell == check.cell and place != check.call.place and first <= place[0] <= last and claims[-1].raised
        for (cell, place), claims in result.reported.items()
    )
