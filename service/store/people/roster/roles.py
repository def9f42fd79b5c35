"""Roles in the words of other tools."""

import re
from collections.abc import Iterable

from service.store.people.people import ROLES
from service.store.people.sort_keys import fold

# As ``_plain`` gives them: "Dozent/in", "Dozent*in" and "DozentIn" are all "dozentin".
WORDS = {
    "student": (
        "student", "students", "learner", "studentenrollment", "studentin", "studierende", "studierender",
        "teilnehmer", "teilnehmerin", "teilnehmende", "mitglied", "horer", "horerin", "autor", "autorin",
    ),
    "assistant": (
        "assistant", "ta", "teachingassistant", "taenrollment", "grader", "reader", "tutor", "tutorin",
        "noneditingteacher", "assistent", "assistentin", "hiwi", "betreuer", "betreuerin",
        "trainerinohnebearbeitungsrecht", "lehrerinohnebearbeitungsrecht", "kurstutor", "kurstutorin",
    ),
    "instructor": (
        "instructor", "teacher", "teacherenrollment", "professor", "professorin", "editingteacher", "dozent",
        "dozentin", "lehrende", "lehrender", "lehrer", "lehrerin", "trainer", "trainerin",
        "courseadministrator", "kursadministrator", "kursadministratorin", "kursleitung", "manager",
        "managerin",
    ),
    "former": ("former", "inactive", "ehemalig", "ehemalige", "ehemaliger"),
}  # fmt: skip
RANK = ("former", "student", "assistant", "instructor")


def role_of(words: str) -> str | None:
    """Return the role that a cell names; of several, separated by commas, the one with most permissions.

    Return None if one of them is unknown.
    """
    roles = [_role(word) for word in words.split(",")]
    return None if None in roles else highest(role for role in roles if role)


def highest(roles: Iterable[str]) -> str:
    """Return the role with the most permissions."""
    return max(roles, key=RANK.index)


def _role(word: str) -> str | None:
    plain = re.sub(r"[\W_]", "", fold(word))
    return next((role for role in ROLES if plain in WORDS[role]), None)
