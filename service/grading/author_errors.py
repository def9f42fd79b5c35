"""Errors of an assignment's own code: a system fault with file and line, never a student's ✗ or –."""

import secrets
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from ecp.author_errors import UNUSABLE, AuthorError, same_error
from ecp.outcome import Ended, SceneEnd
from exercises.assignment import Assignment, InvalidAssignment, NoAssignment
from exercises.catalogue import find
from exercises.validation import format_error
from service.sandbox.job import Cell, Job
from service.sandbox.result import NotPrepared, OnScene, PlayResult, SystemFault, ignore
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import TimeBudget

FAULT = "assignment {slug} has an error: {error}"
NO_SUBMISSION = """
class {name}: pass
def {function}(*values, **named): return {name}()
"""
"""Replaces a right submission where none is known. What it returns has no properties, and a submission cannot
return the same.
"""


class AssignmentFault(SystemFault):
    """The assignment's own code failed. The message names file and line, for the course staff."""


@contextmanager
def author_errors(assignment: Assignment, *, numbers: bool = False) -> Iterator[None]:
    """Turn an exception of the assignment's own code into an AssignmentFault.

    That is every AuthorError and every exception with a frame in the assignment's folder. ArithmeticError and
    ValueError stay as they are if the code reads a student's ``numbers``.
    """
    try:
        yield
    except (AuthorError, NotPrepared) as error:
        raise _fault(assignment, str(error)) from error
    except SystemFault:
        raise
    except (Exception, SystemExit) as error:
        frames = traceback.extract_tb(error.__traceback__)
        own = any(Path(frame.filename).is_relative_to(assignment.folder) for frame in frames)
        if not own or (numbers and isinstance(error, ArithmeticError | ValueError)):
            raise
        raise _fault(assignment, format_error(error, assignment.folder)) from error


def play(
    job: Job,
    assignment: Assignment,
    sandbox: Sandbox,
    on_scene: OnScene = ignore,
    budget: TimeBudget | None = None,
) -> PlayResult:
    """Play the job as ``Sandbox.play`` does. Raises AssignmentFault if a scene fails because of the
    assignment.

    A scene whose exception the submission's code did not raise itself is played again, in another child, with
    a right submission. If it fails at the same place, the assignment is the cause, else what the student's
    function returned.
    """
    result = sandbox.play(job, on_scene, budget)
    for scene in job.scenes:
        if (found := result.author_errors.get(scene.name)) is None:
            continue
        source = assignment.right_submission(scene.function)
        known = source is not None
        if source is None:
            source = NO_SUBMISSION.format(name=f"_{secrets.token_hex(8)}", function=scene.function)
        right = replace(job, cells=(Cell("solution.py", source),), scenes=(replace(scene, after=None),))
        other = sandbox.play(
            right, budget=TimeBudget(sandbox.limits.at_least(assignment.cpu_s))
        ).author_errors.get(scene.name)
        if other is not None and (same_error(found, other) if known else found == other):
            raise _fault(assignment, f"scene {scene.name}: {other}")
        sentence = UNUSABLE.format(function=scene.function, error=result.scene_ends[scene.name].sentence)
        result.scene_ends[scene.name] = SceneEnd(
            scene=scene.name, ended=Ended.WRONG_ANSWER, sentence=sentence
        )
    return result


def find_assignment(slug: str) -> Assignment:
    """Return the assignment. Raises SystemFault if it is invalid or does not exist."""
    try:
        return find(slug)
    except (InvalidAssignment, NoAssignment) as error:
        raise SystemFault(f"assignment {slug} is invalid or missing; run polhode verify {slug}") from error


def _fault(assignment: Assignment, error: str) -> AssignmentFault:
    return AssignmentFault(FAULT.format(slug=assignment.slug, error=error))
