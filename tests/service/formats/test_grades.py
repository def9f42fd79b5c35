"""Our own CSV, by golden files, and read back."""

import csv
import dataclasses
import io
import json
from pathlib import Path

from service.formats import grades
from tests.support.grade_rows import CHECKS, CLASS, row

GOLDEN = Path(__file__).parent / "golden"


def golden(name, text):
    assert text == (GOLDEN / name).read_bytes().decode()


def test_an_assignment():
    golden("grades.csv", grades.assignment_csv(CLASS, [*CHECKS, "9-of-old"]))


def test_a_course():
    other = [
        dataclasses.replace(one, assignment="tops", points=None if one.points is None else 10, max_points=10)
        for one in CLASS[:3]
    ]
    golden("course.csv", grades.course_csv([*CLASS, *other]))


def test_it_is_read_back_by_name_of_column():
    lines = list(
        csv.DictReader(io.StringIO(grades.assignment_csv(CLASS, CHECKS).removeprefix("\ufeff"), newline=""))
    )
    assert [line["points"] for line in lines] == ["2", "1", "1", "", ""]
    assert [line["percent"] for line in lines] == ["100.0", "50.0", "50.0", "", ""]
    assert (
        lines[2]["2-energy"] == "pass (override)"
        and lines[2]["2-motion"] == "timeout"
        and lines[2]["overridden"] == "yes"
    )
    assert [lines[3][name] for name in ("late", "overridden", "submission", "2-energy", "status")] == [
        "",
        "",
        "",
        "",
        "none",
    ]
    assert lines[4]["status"] == "faulted" and lines[0]["student_id"] == "00815"


def test_json_has_numbers_null_and_texts_as_they_are():
    evil = row("=1", 2, full_name="＝cmd|' /C calc'!A0\n\u202e", email="@x")
    students = json.loads(grades.assignment_json({"assignment": "rigid-body"}, [*CLASS, evil]))["students"]
    assert [s["points"] for s in students] == [2, 1, 1, None, None, 2]
    assert (students[5]["student"], students[5]["full_name"], students[5]["email"]) == (
        evil.student,
        evil.full_name,
        evil.email,
    )
    assert students[2]["checks"] == {
        "2-energy": {"state": "fail", "given": 1, "points": 1, "earned": 0},
        "2-motion": {"state": "timeout", "given": None, "points": 1, "earned": 0},
    }
    assert (
        students[0]["submitted_at"] == "2026-02-28T23:59:58Z"
        and students[3]["late"] is None
        and students[3]["checks"] == {}
    )


def test_a_check_of_several_points_passes_if_an_override_gives_all_of_them():
    partly, fully = (
        row("ann", n, worth={"2-energy": 4, "2-motion": 1}, given={"2-energy": n}) for n in (3, 4)
    )
    assert (partly.state("2-energy"), fully.state("2-energy")) == ("fail", "pass")


def test_the_most_points_leave_out_what_may_be_left_out(rigid_body):
    everything = {check.id for exercise in rigid_body.exercises for check in exercise.checks}
    optional = {"4-function", "4-retrograde", "4-coarse", "4-short", "5-moves", "5-follows"}
    assert optional < everything and rigid_body.max_points() == len(everything - optional)
    assert rigid_body.bonus_points() == len(optional)
