"""The CSV as nbgrader writes it, and by its rules."""

import csv
import io
from datetime import datetime

import pytest

from service.formats import nbgrader
from tests.service.formats.test_grades_csv import golden
from tests.support.grade_rows import CLASS, row


def test_the_golden_file():
    golden("nbgrader.csv", nbgrader.text(CLASS))


def test_its_rules():
    lines = list(csv.DictReader(io.StringIO(nbgrader.text(CLASS), newline="")))
    assert len(lines) == len(CLASS)
    for line in lines:
        if line["score"]:
            assert float(line["score"]) == max(0.0, float(line["raw_score"]) - float(line["late_submission_penalty"]))
        for name in ("duedate", "timestamp"):
            assert line[name] == "" or datetime.fromisoformat(line[name]).tzinfo is None
    by_student = {line["student_id"]: line for line in lines}
    assert by_student["dora"]["score"] == "0.0" and by_student["dora"]["timestamp"] == ""
    assert by_student["eve"]["score"] == "" and by_student["eve"]["timestamp"]  # a fault of ours is no zero
    keys = [(line["last_name"], line["first_name"]) for line in lines]
    assert keys == sorted(keys)


@pytest.mark.parametrize(
    ("full", "split"),
    [
        ("Ada Lovelace", ("Lovelace", "Ada")),
        ("van Dyk, Ben", ("van Dyk", "Ben")),
        ("Plato", ("Plato", "")),
        ("", ("", "")),
        ("A B C", ("C", "A B")),
    ],
)
def test_names(full, split):
    assert nbgrader.names(full) == split


def test_a_formula_split_off_a_name_is_none():
    assert "'=1+1,'=2" in nbgrader.text([row("x", 1, full_name="=1+1, =2")])
