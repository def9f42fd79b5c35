"""Every error of a declaration is reported at once, with its line."""

import textwrap

import pytest

from tests.support.assignments import known

HEAD = """\
from exercises.authoring.questions.author import Notebook, Tolerance, Value, family, itself, mistake, uniform
from exercises.authoring.kinds.values import values
notebook = Notebook("One", setup="import numpy as np")
def double(x):
    return 2 * x
def exact(x):
    return x + x
"""
LINE = HEAD.count("\n") + 1
NEAR = 'Tolerance(limit=1e-12, reason="rounding")'


def errors(tmp_path, declared):
    """What is wrong with an assignment whose exercise 1 has this question."""
    (tmp_path / "one").mkdir()
    (tmp_path / "one" / "assignment.py").write_text(
        f"{HEAD}notebook.exercise('1', 'One', {textwrap.dedent(declared)})\n"
    )
    with known(tmp_path / "one") as catalogue:
        return catalogue.invalid["one"].errors if catalogue.invalid else []


def test_a_sound_declaration_has_no_errors(tmp_path):
    question = (
        f"values(double, ask={{'x': uniform(0, 1)}}, truth=exact, agree={NEAR}, mistakes=[mistake('2 *', '3"
        " *')])"
    )
    assert errors(tmp_path, question) == []


@pytest.mark.parametrize(
    ("question", "error"),
    [
        (
            "values(double, ask={'y': uniform(0, 1)}, truth=itself('a'), agree=NEAR)",
            "double takes (x), but ask names (y)",
        ),
        ("values(double, ask={'x': uniform(0, 1)}, agree=NEAR)", "double has no truth: give a closed form"),
        (
            "values(double, ask={'x': uniform(0, 1)}, truth=double, agree=NEAR)",
            "the truth of double is its own solution",
        ),
        (
            "values(double, ask={'x': uniform(0, 1)}, truth=itself(' '), agree=NEAR)",
            "double: truth: reason is ' '; it must be a text",
        ),
        (
            "values(double, ask={'x': uniform(0, 1)}, truth=lambda z: z, agree=NEAR)",
            "takes z, which is neither asked nor drawn",
        ),
        (
            "values(double, ask={'x': 1.0}, truth=exact, agree=Tolerance(limit=1e-9, reason=''))",
            "the tolerance has no reason",
        ),
        (
            "values(double, ask={'x': 1.0}, truth=exact, agree=Tolerance(reason='a'))",
            "the tolerance has no number",
        ),
        (
            "values(double, ask={'x': 1.0}, truth=exact, agree=Tolerance(atol=-1.0, reason='a'))",
            "must be a finite number ≥ 0",
        ),
        (
            "values(double, ask={'x': 1.0}, truth=exact, agree=NEAR, up_to='luck')",
            "up_to is 'luck'; it must be one of: sign, ",
        ),
        (
            "values(double, ask={'x': 1.0}, truth=exact, agree=NEAR, points=0)",
            "points is 0; it must be an integer from 1 to 1000",
        ),
        (
            "values(double, ask={'x': 1.0}, truth=exact, agree=NEAR, points=1.5)",
            "points is 1.5; it must be an integer",
        ),
        (
            "values(double, ask={'x': uniform(0, 1)}, truth=exact, agree=NEAR, partial=True)",
            "needs points of at least 2",
        ),
        (
            "values(double, ask={'x': 1.0}, truth=exact, agree=NEAR, points=2, partial=True)",
            "partial credit needs drawn arguments",
        ),
        (
            "values(double, ask={'x': 1.0}, truth=exact, agree={'a': NEAR}, points=2)",
            "double: label=, up_to=, points= and partial= are for",
        ),
        (
            "values(double, ask={'x': family('a*', 't')}, truth=exact, agree=NEAR)",
            "double: ask: x: text is 'a*'; it must be an expression",
        ),
        (
            "values(double, ask={'x': family('a*t', 't')}, truth=exact, agree=NEAR)",
            "'a*t' uses a, which is neither a variable",
        ),
        (
            (
                "values(double, ask={'x': family('t', 't')}, truth=itself('a'), agree=NEAR,"
                " calls=Tolerance(limit=len, reason='a'))"
            ),
            "double: calls: limit is <built-in function len>; it must be a number",
        ),
        (
            "values(min, ask={'x': 1.0}, truth=exact, agree=NEAR)",
            "the solution is named min, which Python or the kit already uses",
        ),
        (
            "values(eval('lambda x: x'), ask={'x': 1.0}, truth=exact, agree=NEAR)",
            "the solution is named <lambda>",
        ),
        (
            "values(double, ask={'x': 1.0}, truth=exact, agree=NEAR, mistakes=[mistake('5', '6')])",
            "replaces '5', which is not in",
        ),
        (
            "values(double, ask={'x': 1.0}, truth=exact, agree=NEAR, mistakes=[mistake('2 *', '2  *')])",
            "changes nothing",
        ),
        (
            "values(double, ask={'x': 1.0}, truth=exact, agree=NEAR, mistakes=[mistake('2 *', '2 * *')])",
            "is not valid Python",
        ),
        (
            (
                "values(double, ask={'x': 1.0}, truth=exact, agree=NEAR, mistakes=[mistake('2', '3', 'A b',"
                " 'c')])"
            ),
            "'A b' must be lower-case",
        ),
        (
            "values(double, ask={'x': 1.0}, truth=exact, agree=NEAR, mistakes=[mistake('2', '3', 'a')])",
            "has no sentence",
        ),
    ],
)
def test_an_error_is_reported_with_its_line(tmp_path, question, error):
    (found,) = errors(tmp_path, question.replace("NEAR", NEAR))
    assert found.startswith(f"assignment.py line {LINE}: ") and error in found


@pytest.mark.parametrize(
    ("used", "error"),
    [
        ("double", "double uses double, which is not the solution of an earlier question"),
        ("exact", "double uses exact, which is not the solution of an earlier question"),
        ("'double'", "double uses 'double', which is not the solution of an earlier question"),
    ],
)
def test_a_question_uses_solutions_of_earlier_questions_only(tmp_path, used, error):
    question = f"values(double, ask={{'x': uniform(0, 1)}}, truth=exact, agree={NEAR}, uses=[{used}])"
    assert errors(tmp_path, question) == [f"assignment.py line {LINE}: {error}"]


def test_a_question_may_use_functions_and_no_classes(tmp_path):
    declared = f"""values(Box, ask={{'x': 1.0}}, call='Box().x', truth=itself('a'), agree={NEAR}), values(
        double, ask={{'x': 1.0}}, truth=exact, agree={NEAR}, uses=[Box])"""
    head = HEAD + "class Box:\n    x = 1.0\n"
    (tmp_path / "one").mkdir()
    (tmp_path / "one" / "assignment.py").write_text(f"{head}notebook.exercise('1', 'One', {declared})\n")
    with known(tmp_path / "one") as catalogue:
        assert [error.split(": ")[1] for error in catalogue.invalid["one"].errors] == [
            "double uses Box, a class or a cell; only a function can be replaced"
        ]


def test_all_errors_are_reported_together(tmp_path):
    found = errors(
        tmp_path, "values(double, ask={'y': 1.0}, agree=Tolerance(reason=''), mistakes=[mistake('5', '6')])"
    )
    assert len(found) == 5


def test_a_file_that_makes_no_notebook_or_two_is_invalid(tmp_path):
    (tmp_path / "two").mkdir()
    for text, number in (
        ("x = 1\n", 0),
        (
            "from exercises.authoring.questions.author import Notebook\n"
            "a, b = Notebook('A'), Notebook('B')\n",
            2,
        ),
    ):
        (tmp_path / "two" / "assignment.py").write_text(text)
        with known(tmp_path / "two") as catalogue:
            assert catalogue.invalid["two"].errors == [
                f"assignment.py makes {number} notebooks; it must make one"
            ]


def test_an_exception_in_the_file_has_its_line(tmp_path):
    (tmp_path / "three").mkdir()
    (tmp_path / "three" / "assignment.py").write_text("x = 1\n1 / 0\n")
    with known(tmp_path / "three") as catalogue:
        assert catalogue.invalid["three"].errors == [
            "assignment.py line 2: ZeroDivisionError: division by zero"
        ]
