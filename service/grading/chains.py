"""Chains of questions: one that uses an earlier function is judged with the reference where the student's
function is wrong.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import groupby
from typing import Any

from exercises.authoring.assignments.assignment import Assignment
from polhode.judging.outcome import Ended
from service.grading.judge_exercise import passes
from service.grading.run_in_sandbox import PlayedJob, play_job
from service.sandbox.job import Job, ReferenceFunctions
from service.sandbox.sandbox import Sandbox


@dataclass
class Chains:
    """Which functions the questions used: the ``remarks`` on a scene's outcomes, and what each question
    ``used`` by its id.
    """

    remarks: dict[str, list[str]] = field(default_factory=dict)
    used: dict[str, str] = field(default_factory=dict)


def with_used(assignment: Assignment, wanted: Iterable[str]) -> set[str]:
    """Return the ``wanted`` scenes and those of the questions whose functions they use."""
    found = set(wanted)
    for scene in reversed(assignment.scenes):
        if scene.name in found and scene.question is not None and (uses := scene.question.get("uses")):
            found |= {s.name for s in assignment.scenes if s.question is not None and s.function in uses}
    return found


def play_chains(assignment: Assignment, played: PlayedJob, sandbox: Sandbox) -> Chains:
    """Play the scenes of a question again with reference functions if a check of it fails and a function that
    it uses is wrong.

    The new results replace those in ``played``, unless fewer checks pass, or as few and there the reference
    makes the submission raise an exception. If it does, the reference first returns its values in the form
    of the submission's function. A function that passes its checks only with reference functions is used
    together with them.
    """
    chains = Chains()
    needed: dict[
        str, set[str]
    ] = {}  # by function: those to replace so that it is right, itself if it is wrong
    for question, names in _questions(assignment, played.job):
        checks = [check for check in assignment.checks() if check.scenes and names.issuperset(check.scenes)]
        passed = sum(passes(assignment, check, played) for check in checks)
        replaced = set[str]().union(*(needed.get(name, ()) for name in question.get("uses", ())))
        may_pass = question["function"] in played.result.defined or played.result.cells
        if passed < len(checks) and replaced and may_pass:
            scenes = tuple(scene for scene in played.job.scenes if scene.name in names)
            reference = ReferenceFunctions(tuple(sorted(replaced)), assignment.source_before(question["id"]))
            job = replace(played.job, scenes=scenes, reference=reference)
            again = play_job(job, assignment, dict(played.inputs), sandbox, played.budget)
            if _stopped(names, again):
                job = replace(job, reference=replace(reference, formed=True))
                again = play_job(job, assignment, dict(played.inputs), sandbox, played.budget)
            found = sum(passes(assignment, check, again) for check in checks)
            if found < passed or (found == passed and _stopped(names, again) - _stopped(names, played)):
                replaced = set()
            else:
                passed = found
                _adopt(names, played, again)
                chains.remarks |= {
                    name: [_remark(function, played) for function in sorted(replaced)] for name in names
                }
        else:
            replaced = set()
        if uses := question.get("uses"):
            used = dict.fromkeys(uses, "the submission's") | dict.fromkeys(sorted(replaced), "the reference")
            chains.used[question["id"]] = ", ".join(f"{whose} {name}" for name, whose in used.items())
        needed.setdefault(question["function"], set()).update(
            replaced if passed == len(checks) else {question["function"]}
        )
    return chains


def _questions(assignment: Assignment, job: Job) -> Iterator[tuple[Mapping[str, Any], set[str]]]:
    """Yield each question that is part of a chain, with the names of its scenes."""
    asked = {scene.name for scene in job.scenes}
    scenes = [
        (scene.question, scene.name)
        for scene in assignment.scenes
        if scene.name in asked and scene.question is not None
    ]
    used = {name for question, _ in scenes for name in question.get("uses", ())}
    for _, group in groupby(scenes, lambda scene: scene[0]["id"]):
        (question, name), *others = group
        if question["function"] in used or question.get("uses"):
            yield question, {name, *(other for _, other in others)}


def _stopped(names: set[str], played: PlayedJob) -> set[str]:
    """Return the scenes that an exception ended, of their own or of the cell that computes a variable."""
    ends = played.result.scene_ends
    by_exception = (Ended.RAISED, Ended.WRONG_ANSWER, Ended.MISSING)
    return {name for name in names if name in ends and ends[name].ended in by_exception}


def _adopt(names: set[str], played: PlayedJob, again: PlayedJob) -> None:
    for name in names:
        played.result.arrays.pop(name, None)
        played.result.scene_ends.pop(name, None)
        played.result.notes.pop(name, None)
    played.result.arrays |= again.result.arrays
    played.result.notes |= again.result.notes
    played.result.scene_ends |= again.result.scene_ends
    played.truths.update(again.truths)


def _remark(name: str, played: PlayedJob) -> str:
    reason = "yours does not pass its checks" if name in played.result.defined else "you have not written it"
    return f"used the reference {name}, because {reason}"
