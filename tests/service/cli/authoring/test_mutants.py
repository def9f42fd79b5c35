"""The strength of the checks, on a few mutants in the real sandbox; `polhode mutants` does all."""

import os
import re

import pytest

from exercises.authoring.mutants.solution import Variant
from service.cli.__main__ import main
from service.cli.authoring import mutants
from service.cli.authoring.mutants import MutantResult, grade_mutants, kill_rate, table, together
from tests.support.assignments import known
from tests.support.author_notebooks import declared


@pytest.mark.slow  # make exhaustive runs all mutants
def test_a_few_in_the_sandbox(rigid_body, monkeypatch):
    monkeypatch.setattr(os, "cpu_count", lambda: 1)
    found = list(grade_mutants(rigid_body, most=6))
    assert len(found) == 6 and all(f.wrong and not f.accepted for f in found)


def test_a_function_that_later_exercises_use_is_changed_once(rigid_body, monkeypatch):
    monkeypatch.setattr(mutants, "play_variants", lambda *arguments, **options: {})
    asked = {of for of in (one.of for one in grade_mutants(rigid_body)) if of.startswith("euler_eqs")}
    assert asked == {"euler_eqs, exercise 2"}


def test_the_command_says_what_is_missing(capsys):
    assert main(["mutants", "nowhere"]) == 2
    assert "cannot grade mutants: there is no assignment nowhere; known: " in capsys.readouterr().err


def test_table():
    one, two = Variant("kind a", "x", ""), Variant("kind b", "y", "")
    found = [
        MutantResult(one, "f", wrong=True, accepted=True),
        MutantResult(one, "f", wrong=False, accepted=True),
        MutantResult(two, "f", wrong=True, accepted=False),
    ]
    assert table(found).split("\n") == [
        "| changed functions | made | turned out correct | wrong, but accepted |",
        "|---|---|---|---|",
        "| kind a | 2 | 1 | 1 |",
        "| kind b | 1 | 0 | 0 |",
        "| all | 3 | 1 | 1 |",
    ]


DECLARED = """
from exercises.authoring import Notebook, absolute, between

notebook = Notebook("notebook.ipynb")


@notebook.exercise("1")
def doubling(ask):
    double = ask.function("double")
    double.case("any number", x=between(0, 1))
    double.truth(lambda x: x + x, agree=absolute(0.5, because="a wide one"))
"""
DOUBLE = """
def double(x):
    y = abs(2 * x)
    return y - x + x
"""


def test_the_variants_of_a_declaration(tmp_path, capsys):
    with known(declared(tmp_path / "doubling", DECLARED, DOUBLE)):
        assert main(["mutants", "doubling"]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert "turned out correct: double, exercise 1: wrong-function, `abs` is missing in `abs(2 * x)`" in lines
    assert "WRONG, BUT ACCEPTED: double, exercise 1: constant-factor, `x` is halved in `y - x`" in lines
    assert any(
        re.fullmatch(r"(\d+) of \d+ wrong functions that return numbers fail a check \(\d\d\.\d %\)", line)
        for line in lines
    )


def test_the_rate_counts_wrong_functions_that_return_numbers():
    one = Variant("a", "x", "")
    rejected, right, accepted = (
        MutantResult(one, "f", wrong, accepted)
        for wrong, accepted in ((True, False), (False, True), (True, True))
    )
    no_numbers = MutantResult(one, "f", wrong=True, accepted=False, measured=False)
    found = [rejected, rejected, right, accepted, no_numbers]
    assert kill_rate(found) == "2 of 3 wrong functions that return numbers fail a check (66.7 %)"


def test_a_mutant_of_a_function_with_two_cases_is_one():
    one, two = Variant("a", "x", "changed"), Variant("a", "y", "changed elsewhere")
    of_numbers = MutantResult(one, "f", wrong=False, accepted=True)
    of_arrays = MutantResult(one, "f", wrong=True, accepted=False)
    other = MutantResult(two, "f", wrong=True, accepted=True)
    assert list(together([of_numbers, other, of_arrays])) == [of_arrays, other]
