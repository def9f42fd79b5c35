"""The strength of the checks, on a few mutants in the real sandbox; `polhode mutants` does all."""

import os

import pytest

from exercises.mutation import Variant
from service.cli.__main__ import main
from service.cli.mutants import Mutant, grade_mutants, table


@pytest.mark.slow  # make exhaustive runs all mutants
def test_a_few_in_the_sandbox(rigid_body, monkeypatch):
    monkeypatch.setattr(os, "cpu_count", lambda: 1)
    found = list(grade_mutants(rigid_body, ["euler_eqs"], most=6))
    assert len(found) == 6 and not any(mutant.accepted for mutant in found)
    assert {mutant.function for mutant in found} == {"euler_eqs"}


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["nowhere"], "there is no assignment nowhere; known: "),
        (["rigid-body", "euler"], "no right submission defines euler: add a sample"),
    ],
)
def test_the_command_says_what_is_missing(arguments, reason, capsys):
    assert main(["mutants", *arguments]) == 2
    assert f"cannot grade mutants: {reason}" in capsys.readouterr().err


def test_table():
    sign, factor = (Variant(code, "x", "", 1) for code in ("sign-flipped", "constant-factor"))
    found = [
        Mutant("f", sign, public=True, accepted=False),
        Mutant("f", sign, public=False, accepted=False),
        Mutant("f", factor, public=True, accepted=True),
        Mutant("g", factor, public=False, accepted=False),
    ]
    assert table(found).split("\n") == [
        "| function | changed | made | accepted by the public checks | accepted by all checks |",
        "|---|---|---|---|---|",
        "| f | sign-flipped | 2 | 1 | 0 |",
        "| f | constant-factor | 1 | 1 | 1 |",
        "| g | constant-factor | 1 | 0 | 0 |",
        "| all |  | 4 | 2 | 1 |",
    ]
