"""Whether a line carries points follows from its declaration."""

import pytest

from exercises.authoring import Notebook
from exercises.authoring.importing.reported_lines import Status, is_self_reported
from tests.support.course_shape import published, written


def declared(home, **arguments):
    """A notebook whose declaration takes over one line with these arguments."""
    written(home, "sums.ipynb", published())
    made = Notebook("sums.ipynb")

    @made.exercise("1", "Task 1")
    def task(ask):
        ask.line("twice the sum is 20", **arguments)

    return made


@pytest.mark.parametrize(
    ("arguments", "status"),
    [
        ({}, Status.SELF_REPORTED),
        ({"truth": 20}, Status.COUNTS),
        ({"trust": True}, Status.COUNTS),
        ({"truth": 20, "shown": True}, Status.SHOWN),
        ({"truth": 20, "shown": True, "accept": True}, Status.COUNTS),
        ({"given": True}, Status.GIVEN),
    ],
)
def test_a_line_counts_if_it_is_compared_with_what_a_student_cannot_know(tmp_path, arguments, status):
    made = declared(tmp_path, **arguments)
    assert made.errors(tmp_path) == []
    assignment = made.assignment(tmp_path)
    (check,) = assignment.checks()
    assert check.declared.status is status
    assert (assignment.points_note == "") is (check.points == 1) is (status is Status.COUNTS)
    assert is_self_reported(check) is (status is Status.SELF_REPORTED)
    outcome = check.reported([], "the cell stopped")
    assert outcome.counted is (status is Status.COUNTS) and status.value in outcome.tolerance.reason


def test_what_is_right_without_a_student_cannot_be_made_to_count(tmp_path):
    (error,) = declared(tmp_path, given=True, trust=True).errors(tmp_path)
    assert "with given=True it is ✓ without any student's code, so it cannot count" in error
