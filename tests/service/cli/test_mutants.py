"""The strength of the checks, on a few mutants in the real sandbox; `polhode mutants` does all."""

import os
import re

import pytest

from exercises.solution import Variant
from service.cli.__main__ import main
from service.cli.mutants import POLHODE, MutantResult, grade_mutants, kill_rate, table
from tests.support.assignments import known


@pytest.mark.slow  # make exhaustive runs all mutants
def test_a_few_in_the_sandbox(rigid_body, monkeypatch):
    monkeypatch.setattr(os, "cpu_count", lambda: 1)
    found = list(grade_mutants(rigid_body, most=6))
    assert len(found) == 6 and all(f.wrong and POLHODE not in f.accepted for f in found)


def test_the_command_tells_what_is_missing(capsys):
    assert main(["mutants", "nowhere"]) == 2
    assert "cannot grade mutants: there is no assignment nowhere; known: " in capsys.readouterr().err


def test_table():
    one, two = Variant("kind a", "x", ""), Variant("kind b", "y", "")
    found = [
        MutantResult(one, True, frozenset(["some"])),
        MutantResult(one, False, frozenset([POLHODE])),
        MutantResult(two, True, frozenset()),
    ]
    assert table(found).split("\n") == [
        "| changed functions | made | turned out correct | wrong, accepted by some | wrong, accepted by polhode |",
        "|---|---|---|---|---|",
        "| kind a | 2 | 1 | 1 | 0 |",
        "| kind b | 1 | 0 | 0 | 0 |",
        "| all | 3 | 1 | 1 | 0 |",
    ]


DECLARED = """
from exercises.author import Notebook, Tolerance, uniform
from exercises.kinds.values import values

notebook = Notebook("Doubling")


def double(x):
    y = abs(2 * x)
    return y - x + x


NEAR = Tolerance(atol=0.5, reason="a wide one")
notebook.exercise("1", "Doubling", values(double, ask={"x": uniform(0, 1)}, truth=lambda x: x + x, agree=NEAR))
"""


def test_the_variants_of_a_declaration(tmp_path, capsys):
    folder = tmp_path / "doubling"
    folder.mkdir()
    (folder / "assignment.py").write_text(DECLARED)
    with known(folder):
        assert main(["mutants", "doubling"]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert "turned out correct: wrong-function, `abs` is missing in `abs(2 * x)`" in lines
    assert "WRONG, BUT ACCEPTED: constant-factor, `x` is halved in `y - x`" in lines
    assert any(
        re.fullmatch(r"(\d+) of \d+ wrong functions that return numbers fail a check \(\d\d\.\d %\)", line) for line in lines
    )


def test_the_rate_counts_wrong_functions_that_return_numbers():
    one, accepted, no_numbers = Variant("a", "x", ""), frozenset([POLHODE]), False
    rejected = [MutantResult(one, True, frozenset()), MutantResult(one, True, frozenset())]
    others = [
        MutantResult(one, False, accepted),
        MutantResult(one, True, accepted),
        MutantResult(one, True, frozenset(), no_numbers),
    ]
    assert kill_rate(rejected + others) == "2 of 3 wrong functions that return numbers fail a check (66.7 %)"
