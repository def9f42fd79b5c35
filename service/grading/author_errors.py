"""Errors of an assignment's own code: a system fault with file and line, never a student's ✗ or –."""

import re
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from exercises.authoring.assignments.assignment import Assignment, InvalidAssignment, NoAssignment
from exercises.authoring.assignments.catalogue import find
from exercises.authoring.assignments.validation import format_error
from polhode.judging.author_errors import AuthorError
from service.sandbox.result import NotPrepared, SystemFault

FAULT = "assignment {slug} has an error: {error}"
MISSING_MODULE = re.compile(r"\bModuleNotFoundError: No module named '[^']*'$")
PACKAGES = ": name the distribution that has it in packages=(…,) of Notebook, and install it beside polhode"


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
        remedy = PACKAGES if MISSING_MODULE.search(str(error)) else ""
        raise fault(assignment, f"{error}{remedy}") from error
    except SystemFault:
        raise
    except (Exception, SystemExit) as error:
        frames = traceback.extract_tb(error.__traceback__)
        own = any(Path(frame.filename).is_relative_to(assignment.folder) for frame in frames)
        if not own or (numbers and isinstance(error, ArithmeticError | ValueError)):
            raise
        raise fault(assignment, format_error(error, assignment.folder)) from error


def find_assignment(slug: str) -> Assignment:
    """Return the assignment. Raises SystemFault if it is invalid or does not exist."""
    try:
        return find(slug)
    except (InvalidAssignment, NoAssignment) as error:
        raise SystemFault(f"assignment {slug} is invalid or missing; run polhode verify {slug}") from error


def fault(assignment: Assignment, error: str) -> AssignmentFault:
    """Return the fault of an assignment for an error of its code."""
    return AssignmentFault(FAULT.format(slug=assignment.slug, error=error))
