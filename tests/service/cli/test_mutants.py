"""The strength of the checks, on a few mutants in the real sandbox; `polhode mutants` does all."""

import os

import pytest

from exercises.mutation import Mutant
from service.cli.__main__ import main
from service.cli.mutants import POLHODE, MutantResult, grade_mutants, table


@pytest.mark.slow  # make exhaustive runs all mutants
def test_a_few_in_the_sandbox(rigid_body, monkeypatch):
    monkeypatch.setattr(os, "cpu_count", lambda: 1)
    found = list(grade_mutants(rigid_body, most=6))
    assert len(found) == 6 and all(f.wrong and POLHODE not in f.accepted for f in found)


def test_the_command_tells_what_is_missing(capsys):
    assert main(["mutants", "nowhere"]) == 2
    assert "cannot grade mutants: there is no assignment nowhere; known: " in capsys.readouterr().err


def test_table():
    one, two = Mutant("kind a", "x", ""), Mutant("kind b", "y", "")
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
