"""Whether a line carries points follows from its declaration."""

import pytest

from exercises.authoring.importing.lines import Line, Status, is_self_reported
from exercises.authoring.questions.author import Notebook
from tests.support.course_shape import published, written

TWICE = "twice the sum is 20"


@pytest.mark.parametrize(
    ("declared", "status"),
    [
        (Line(TWICE), Status.SELF_REPORTED),
        (Line(TWICE, truth=20), Status.COUNTS),
        (Line(TWICE, trust=True), Status.COUNTS),
        (Line(TWICE, truth=20, shown=True), Status.SHOWN),
        (Line(TWICE, truth=20, shown=True, accept=True), Status.COUNTS),
        (Line(TWICE, given=True), Status.GIVEN),
    ],
)
def test_a_line_counts_if_it_is_compared_with_what_a_student_cannot_know(tmp_path, declared, status):
    home = tmp_path / "sums"
    written(home, "sums.ipynb", published())
    made = Notebook("Sums", notebook="sums.ipynb")
    made.exercise("1", "Task 1", declared)
    assert declared.status is status and made.errors(home) == []
    assignment = made.assignment(home)
    (check,) = assignment.checks()
    assert (assignment.points_note == "") is (check.points == 1) is (status is Status.COUNTS)
    assert is_self_reported(check) is (status is Status.SELF_REPORTED)
    outcome = check.reported([], "the cell stopped")
    assert outcome.counted is (status is Status.COUNTS) and status.value in outcome.tolerance.reason


def test_what_is_right_without_a_student_cannot_be_made_to_count(tmp_path):
    written(tmp_path, "sums.ipynb", published())
    made = Notebook("Sums", notebook="sums.ipynb")
    made.exercise("1", "Task 1", Line(TWICE, given=True, trust=True, line=9))
    (error,) = made.errors(tmp_path)
    assert "line 9: with given=True it is ✓ without any student's code, so it cannot count" in error
