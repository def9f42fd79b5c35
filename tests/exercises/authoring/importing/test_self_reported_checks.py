"""Validation calls are found in the cells of a published notebook, with label and place."""

import re

import pytest

from exercises.authoring import Notebook
from exercises.authoring.importing.validation_calls import calls as calls_of
from exercises.authoring.importing.validation_words import words
from tests.support.course_shape import published, written


def calls(source, *folders):
    return calls_of(source, words(folders))


@pytest.mark.parametrize(
    ("source", "found"),
    [
        ('validate.close(a, b, "one", rtol=1e-3)', [("close", "one")]),
        (
            'ok = validate.conserved(E, "two")\nok = ok and validate.check(ok, label="three")',
            [("conserved", "two"), ("check", "three")],
        ),
        ('validate.check(\n    a > 1,\n    "four "\n    "lines",\n)', [("check", "four lines")]),
        (
            'for n in x:\n    validate.close(n, 1, f"order {n:.2f} of {len(x)}")',
            [("close", "order {n:.2f} of {len(x)}")],
        ),
        ("validate.below(a, 1, label)", [("below", "{label}")]),
        (
            'ecp.validate.positive(a, "five"); validate.positive(b, "six")',
            [("positive", "five"), ("positive", "six")],
        ),
        ("%matplotlib inline\nvalidate.check(True, 'seven')", [("check", "seven")]),
        ('validate.other(1, "no")\nclose(1, 2, "no")', []),
        ("not python (", []),
    ],
)
def test_calls_are_found_in_order(source, found):
    assert [(call.kind, call.label) for call in calls(source)] == found


def test_a_call_knows_its_place_and_whether_it_is_inside_a_function():
    first, second = calls('x = 1\ndef f():\n    validate.check(True, "a")\nok = validate.check(x, "b")')
    assert (first.place, first.in_function) == ((3, 4), True) and (second.place, second.in_function) == (
        (4, 5),
        False,
    )


def declared(tmp_path, *labels, text=None, **truths):
    """The assignment with lines of these labels, and lines with what is exact by their labels."""
    written(tmp_path, "sums.ipynb", text or published())
    made = Notebook("sums.ipynb")

    @made.exercise("1")
    def task(ask):
        for label in labels:
            ask.line(label)
        for label, truth in truths.items():
            ask.line(label.replace("_", " "), truth=truth)

    return made


def test_lines_that_the_notebook_does_not_have_are_errors_with_their_lines(tmp_path):
    made = declared(tmp_path, "twice the sum is 20", "no such line", the_area_is_positive=3.0)
    wrong = made.errors(tmp_path)
    at = [int(re.match(r"assignment.py line (\d+): ", error)[1]) for error in wrong]
    assert len(wrong) == 2 and at[1] == at[0] + 2
    assert "no validation cell has, after the lines before, the label 'no such line'" in wrong[0]
    assert "validate.positive has no expected value that truth= could replace" in wrong[1]


@pytest.mark.parametrize("truth", ["twenty", float("nan"), {"x": 1}])
def test_a_truth_that_is_no_number_is_an_error(tmp_path, truth):
    (error,) = declared(tmp_path, twice_the_sum_is_20=truth).errors(tmp_path)
    assert "it must be numbers, or a function without parameters" in error


def test_lines_in_another_order_are_an_error(tmp_path):
    wrong = declared(tmp_path, "the sum is positive", "twice the sum is 20").errors(tmp_path)
    assert len(wrong) == 1 and "twice the sum is 20" in wrong[0]


def test_the_student_defines_what_the_lines_read(tmp_path):
    made = declared(tmp_path, "twice the sum is 20", "the sum is positive").assignment(tmp_path)
    (exercise,) = made.exercises
    assert exercise.functions == exercise.variables == ("total",)
    assert made.max_points() == 0 and [check.points for check in exercise.checks] == [0, 0]


def test_a_call_knows_the_numbers_that_its_text_gives():
    source = (
        'validate.close(a, b, "one")\nvalidate.below(a, 2 * 1e-3, "two")\n'
        'validate.conserved(a, "three", rel_drift=3 * sigma)'
    )
    assert [(call.numbers, call.computed) for call in calls(source)] == [
        ((("rtol", 1e-6), ("atol", 1e-9)), ()),
        ((("limit", 2e-3),), ()),
        ((), ("rel_drift",)),
    ]


def test_a_truth_with_a_tolerance_that_the_cell_computes_is_an_error(tmp_path):
    text = published(checks=('validate.close(total, 10, "ten", atol=3 * sigma)\n', "x = 1\n", "x = 1\n"))
    (error,) = declared(tmp_path, text=text, ten=10).errors(tmp_path)
    assert "the validation cell computes atol, which the student's code could widen" in error


PACKAGE = (
    "def close(a, b, label, rtol=1e-3, *, atol=0.0): ...\ndef below(x, threshold, label): ...\n"
    "def check(passed, detail, label): ...\n"
)


def test_places_and_defaults_are_those_of_the_courses_own_package(tmp_path):
    written(tmp_path / "lab", "validate.py", PACKAGE)
    written(tmp_path, "words.txt", "lab.order: converges\n")
    written(tmp_path / "lab", "order.py", "def converges(errors, label): ...\n")
    source = (
        'validate.close(a, b, "one")\nvalidate.close(a, b, "two", 1e-2)\n'
        'validate.below(a, 3.0, "three")\nvalidate.check(a, "why", "four")\norder.converges(e, "five")\n'
        'validate.conserved(a, "six")\n'
    )
    assert [(call.kind, call.label, call.numbers) for call in calls(source, tmp_path)] == [
        ("close", "one", (("rtol", 1e-3), ("atol", 0.0))),
        ("close", "two", (("rtol", 1e-2), ("atol", 0.0))),
        ("below", "three", (("limit", 3.0),)),
        ("check", "four", ()),
        ("converges", "five", ()),
        ("conserved", "six", (("rel_drift", 1e-4),)),
    ]
