"""The zip that a course uploads: setup.sh, which Gradescope runs once, run_autograder, and polhode with its lock."""

import shlex
from collections.abc import Sequence
from pathlib import Path

import exercises
from exercises.assignment import Assignment
from exercises.reproducible import zipped
from service.gradescope.own_wheel import HERE, LOCK, lock, own_wheel

SCRIPTS = ("setup.sh", "run_autograder")
MARK = "{{ARGUMENTS}}"


def bundle(assignment: Assignment, numbers: Sequence[str] | None) -> bytes:
    """The zip, byte for byte the same for the same content; ``numbers``: of the exercises to grade, default those attempted."""
    arguments = ["--assignment", assignment.slug, *(part for number in numbers or () for part in ("--exercise", number))]
    files = {name: (HERE / name).read_text().replace(MARK, shlex.join(arguments)).encode() for name in SCRIPTS}
    ours = assignment.folder.is_relative_to(Path(exercises.__path__[0]))
    name, wheel = own_wheel(*([] if ours else [assignment.folder]))
    return zipped({**files, LOCK: lock(), name: wheel}, runnable=SCRIPTS)
