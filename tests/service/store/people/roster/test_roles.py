"""The words for roles in other tools."""

import pytest

from service.store.people.people import ROLES
from service.store.people.roster.roles import RANK, WORDS, role_of


@pytest.mark.parametrize(
    ("words", "role"),
    [
        ("Student", "student"),
        ("Teilnehmer/in", "student"),
        ("TA", "assistant"),
        ("Tutor*in", "assistant"),
        ("Non-editing teacher", "assistant"),
        ("Trainer/in ohne Bearbeitungsrecht", "assistant"),
        ("DozentIn", "instructor"),
        ("Teilnehmer/in, Trainer/in", "instructor"),
        ("former", "former"),
        ("king", None),
        ("Student, king", None),
    ],
)
def test_the_words_of_other_tools_are_understood(words, role):
    assert role_of(words) == role


def test_every_role_has_words_and_a_rank():
    assert set(WORDS) == set(RANK) == set(ROLES)
