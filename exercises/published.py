"""Whether the public side of an assignment can be played in a student's kernel: what is wrong with it, for its author."""

import importlib
from collections.abc import Iterator, Sequence

from ecp.exercise import Exercise
from exercises.assignment import Assignment
from exercises.folders import told


def errors(assignment: Assignment) -> list[str]:
    """Empty where nothing is wrong, or where there is no folder public/: then ``ecp.check`` does not know the assignment."""
    if not (assignment.folder / "public").is_dir():
        return []
    try:
        public = importlib.import_module(f"exercises.{assignment.folder.name}.public")
    except (Exception, SystemExit) as error:
        return [f"public/: {told(error, assignment.folder)}"]
    if not hasattr(public, "EXERCISES"):
        return ["public/__init__.py defines no EXERCISES"]
    return [f"public/: {error}" for error in _errors(assignment, public.EXERCISES)]


def _errors(assignment: Assignment, exercises: Sequence[Exercise]) -> Iterator[str]:
    served = {e.number: {c.id for c in e.checks} for e in assignment.exercises}
    drawn = {s.name for s in assignment.scenes if callable(s.inputs)}
    for exercise in exercises:
        if exercise.number not in served:
            yield f"the server has no exercise {exercise.number}"
            continue
        yield from (f"the server does not make the check {c.id}" for c in exercise.checks if c.id not in served[exercise.number])
        yield from (
            f"exercise {exercise.number}: no scene {s}" for s in sorted(exercise.scenes() - {s.name for s in assignment.scenes})
        )
        known = sorted(exercise.scenes() & drawn)
        yield from (f"exercise {exercise.number} reads the scene {s}, which is drawn for each attempt" for s in known)
