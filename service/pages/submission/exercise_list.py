"""The task on an assignment's page: its exercises with points and own progress, packages and limits."""

from dataclasses import dataclass

from exercises.authoring.assignments.assignment import Assignment
from service.api.response_models import Past


@dataclass(frozen=True)
class ExerciseRow:
    """An exercise with the names it asks for, its points, those of optional functions, and how many checks of
    the counted submission are ✓ out of those made; ``made`` is 0 if it was not attempted.
    """

    number: str
    title: str
    names: tuple[str, ...]
    points: int
    bonus: int
    passed: int
    made: int


def exercises(assignment: Assignment, counted: Past | None) -> list[ExerciseRow]:
    """Return the exercises with the progress of the person's ``counted`` submission, None without one."""
    verdicts = counted.verdicts if counted else {}
    found = []
    for exercise in assignment.exercises:
        made = [verdicts[check.id] for check in exercise.checks if check.id in verdicts]
        found.append(
            ExerciseRow(
                exercise.number,
                exercise.title,
                tuple(dict.fromkeys((*exercise.functions, *exercise.optional))),
                assignment.max_points([exercise.number]),
                assignment.bonus_points([exercise.number]),
                made.count("pass"),
                len(made),
            )
        )
    return found


def limits(assignment: Assignment) -> str:
    """Return what a submission may use, in words: packages, and seconds for one call."""
    packages = ", ".join(("numpy", "scipy", "matplotlib", *assignment.packages))
    longest = max((scene.budget_s for scene in assignment.scenes), default=0.0)
    return f"{packages}; at most {longest:g} s for one calculation; no network"
