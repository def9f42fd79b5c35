"""Rows of a gradebook for files: as the forms of grades take them."""

import csv
import io

from polhode.judging.verdict import RowsRight
from service.formats import gradebooks, grades
from service.formats.grade_row import row, rows
from tests.support.reports import example, graded_file, outcome, report


def test_a_graded_file(rigid_body):
    told = row(graded_file(example()), rigid_body)
    assert (told.student, told.status, told.points, told.score, told.counted) == ("ann", "graded", 1, 1, 3)
    assert (told.max_points, told.title, told.grader) == (
        36,
        rigid_body.title,
        "polhode 0.1.0, assignment version 1",
    )
    assert told.checks == {
        "1-notebook": "pass",
        "2-pointwise": "fail",
        "2-energy": "error",
        "2-drawn": "unmeasured",
    }


def test_canvas_gets_the_points_of_checks_worth_several_and_their_partial_credit(rigid_body):
    partly = outcome("1-box", "fail", points=4, partial=RowsRight(12, 16))
    graded = row(graded_file(report([outcome("1-notebook", points=2), partly])), rigid_body)
    assert (graded.score, graded.counted, graded.worth["1-box"], graded.earned["1-box"]) == (5, 6, 4, 3)
    assert gradebooks.canvas_csv([graded], "T", 6).splitlines()[1:] == [
        "Points Possible,,,,,6",
        "ann,,,ann,,5",
    ]


def test_what_is_no_submission_has_no_points_and_a_fault_has_no_verdict(rigid_body):
    refused = row(graded_file(None, refused="no text"), rigid_body)
    fault = row(graded_file(None, "b.py", fault="disk full"), rigid_body)
    assert (refused.status, refused.points, refused.counted) == ("refused", 0, None)
    assert (fault.status, fault.points, fault.score) == ("faulted", None, None)
    lines = list(csv.DictReader(io.StringIO(gradebooks.nbgrader_csv([refused, fault]))))
    assert [(line["student_id"], line["score"]) for line in lines] == [("ann", "0.0"), ("b", "")]
    canvas = gradebooks.canvas_csv([refused, fault], "T", 2)
    assert "b,,,b," not in canvas and "ann,,,ann,,0" in canvas


def test_files_of_one_name_are_no_one_student(rigid_body):
    files = [
        graded_file(report([outcome("2-energy")]), name)
        for name in ("ann/mine.py", "ben/mine.ipynb", "cho.py")
    ]
    assert [one.student for one in rows(files, rigid_body)] == ["ann/mine", "ben/mine", "cho"]


def test_a_file_named_like_a_formula_is_none(rigid_body):
    assert "\n'=1+1," in grades.assignment_csv(
        rows([graded_file(example(), "=1+1.py")], rigid_body), []
    ).replace("\r", "")
