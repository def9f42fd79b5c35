"""Every error of a question is reported at once, with its line."""

import pytest

from tests.support.assignments import known
from tests.support.author_notebooks import declared

SOLUTION = "def double(x):\n    return 2 * x"
DECLARED = """
from exercises.authoring import Notebook, Value, absolute, at_most, between, expression, relative

notebook = Notebook("notebook.ipynb")
near = relative(1e-12, because="rounding")


@notebook.exercise("1")
def doubling(ask):
    double = ask.function("double")
    double.case("", x=between(0, 1))
    double.truth(lambda x: x + x, agree=near)
    double.mistake("constant-factor", "it triples", change="2 * -> 3 *")
"""
QUESTION, CASE = 'double = ask.function("double")', 'double.case("", x=between(0, 1))'
TRUTH, MISTAKE = "double.truth(lambda x: x + x, agree=near)", '"it triples", change="2 * -> 3 *"'
EXERCISE = '@notebook.exercise("1")'


def errors(tmp_path, *changes, solution=SOLUTION):
    """What is wrong with the declaration after these changes."""
    text = DECLARED
    for old, new in changes:
        assert text.count(old) == 1
        text = text.replace(old, new)
    with known(declared(tmp_path / "one", text, solution)) as catalogue:
        return catalogue.invalid["one"].errors if catalogue.invalid else []


def line_of(text):
    """The number of the line of the declaration that contains the text."""
    return DECLARED[: DECLARED.index(text)].count("\n") + 1


def test_a_sound_declaration_has_no_errors(tmp_path):
    assert errors(tmp_path) == []


def with_truth(agree, truth="lambda x: x + x"):
    return (TRUTH, f"double.truth({truth}, agree={agree})")


def with_argument(argument):
    return (CASE, f'double.case("", x={argument})')


@pytest.mark.parametrize(
    ("change", "at", "error"),
    [
        ((TRUTH, "double.agree(near)"), CASE, "double has no truth: give a closed form"),
        (with_truth("near", "lambda z: z"), CASE, "takes z, which is neither asked nor drawn"),
        (with_truth('relative(1e-9, because="")'), CASE, "the tolerance has no reason: say it with because="),
        (with_truth('relative(None, because="a")'), CASE, "the tolerance has no number"),
        (with_truth('absolute(-1.0, because="a")'), CASE, "must be a finite number ≥ 0"),
        (with_truth('Value(near, up_to="luck")'), CASE, "up_to is 'luck'; it must be one of: sign, "),
        (with_truth("3"), CASE, "agree: tolerance is 3; it must be a tolerance, such as relative("),
        (with_argument('expression("a*", of="t")'), CASE, "x: text is 'a*'; it must be an expression"),
        (with_argument('expression("a*t", of="t")'), CASE, "'a*t' uses a, which is neither a variable"),
        (with_argument("1j"), CASE, "inputs: x is 1j; it must be"),
        (
            (QUESTION, 'double = ask.function("double", calls=at_most(3, because="a"))'),
            CASE,
            "calls= needs a function argument: expression(…)",
        ),
        ((EXERCISE, '@notebook.exercise("1", points=0)'), EXERCISE, "points is 0; it must be an integer ≥ 1"),
        ((EXERCISE, '@notebook.exercise("1", points=1.5)'), EXERCISE, "points is 1.5; it must be an integer"),
        ((EXERCISE, '@notebook.exercise("1", partial=True)'), EXERCISE, "give points= too"),
        ((MISTAKE, '"it doubles", change="2 * -> 2  *"'), "double.mistake(", "changes nothing"),
        ((MISTAKE, '"it fails", change="2 * -> 2 * *"'), "double.mistake(", "is not valid Python"),
        ((MISTAKE, '" ", change="2 * -> 3 *"'), "double.mistake(", "constant-factor has no sentence"),
    ],
)
def test_an_error_is_reported_with_its_line(tmp_path, change, at, error):
    (found,) = errors(tmp_path, change)
    assert found.startswith(f"assignment.py line {line_of(at)}: ") and error in found


def test_partial_credit_needs_drawn_inputs(tmp_path):
    found = errors(
        tmp_path,
        (EXERCISE, '@notebook.exercise("1", points=4, partial=True)'),
        with_argument("1.0"),
    )
    assert found == [
        f"assignment.py line {line_of(CASE)}: double: partial credit needs drawn arguments: a single input is"
        " right or wrong"
    ]


def test_a_solution_that_is_its_own_truth_needs_a_reason(tmp_path):
    its_own = 'double.is_its_own_truth(because="{}")\n    double.agree(near)'
    assert errors(tmp_path, (TRUTH, its_own.format("it is defined so"))) == []
    (found,) = errors(tmp_path / "again", (TRUTH, its_own.format(" ")))
    assert found.startswith(f"assignment.py line {line_of(CASE)}: double: truth: reason is ' '; it must be a")


def test_inputs_are_those_that_the_solution_takes(tmp_path):
    (found,) = errors(
        tmp_path, (CASE, 'double.case("", z=between(0, 1))'), with_truth("near", "lambda z: 2 * z")
    )
    assert found.endswith("double takes (x), but its inputs are (z)")


def test_a_limit_of_calls_is_a_number(tmp_path):
    limited = (QUESTION, 'double = ask.function("double", calls=at_most(len, because="a"))')
    found = errors(tmp_path, limited, with_argument('expression("t", of="t")'))
    assert found == [
        f"assignment.py line {line_of(CASE)}: double: calls: limit is <built-in function len>; it must be a"
        " number"
    ]


def test_a_name_of_python_is_no_name_of_a_solution(tmp_path):
    changed = [(QUESTION, QUESTION.replace('"double"', '"min"')), with_argument("0.5")]
    (found,) = errors(tmp_path, *changed, solution="def min(x):\n    return 2 * x")
    assert "the solution is named min, which Python or the kit already uses" in found


def test_all_errors_are_reported_together(tmp_path):
    found = errors(
        tmp_path,
        (CASE, 'double.case("", z=1.0)'),
        with_truth('relative(None, because="")'),
        (MISTAKE, '" ", change="2 * -> 2  *"'),
    )
    assert len(found) == 6


def test_a_file_that_makes_no_notebook_or_two_is_invalid(tmp_path):
    (tmp_path / "two").mkdir()
    two = "from exercises.authoring import Notebook\na, b = Notebook('a.ipynb'), Notebook('b.ipynb')\n"
    for text, number in (("x = 1\n", 0), (two, 2)):
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
