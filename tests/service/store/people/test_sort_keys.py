"""The order of people: by surname and first name, whatever the case and the accents."""

import pytest

from service.store.people import people
from service.store.people.sort_keys import fold, sort_key
from tests.support.database import run, sql

IN_ORDER = [
    ("änne", "Änne Abel"),
    ("cem", "Cem Çelik"),
    ("dan", "Dan Cole"),
    ("lee", "Lee, Ann"),
    ("bea", "Bea Lee"),
    ("leeb", "Ada Leeb"),
    ("ost", "Ost"),
    ("øst", "Ida Øst"),
    ("zoe", "Zoé Østby"),
    ("weiss", "Kim Weiss"),
    ("weiß", "Lia Weiß"),
    ("xaver", ""),
]


def test_names_sort_by_surname_with_accents_folded():
    assert sorted(IN_ORDER, key=lambda person: sort_key(*person)) == IN_ORDER


@pytest.mark.parametrize(
    ("text", "folded"), [("ÄÖÜß", "aouss"), ("Łódź", "lodz"), ("Ærø", "aero"), ("né", "ne")]
)
def test_case_and_accents_are_folded(text, folded):
    assert fold(text) == folded


def test_a_known_surname_may_have_several_words():
    key = sort_key("ana", "Ana García Márquez", "García Márquez")
    assert key < sort_key("kim", "Kim Gray") < sort_key("ana", "Ana García Márquez")


def test_lists_have_the_order_of_the_stored_keys(database_url):
    """Also after a change of the full name; a later roster without surnames keeps the place."""

    async def enter(database):
        async with database.begin() as connection:
            roster = [(name, "student", full_name or None) for name, full_name in reversed(IN_ORDER)]
            await people.enroll(connection, [*roster, ("ana", None, "Ana Zar")])
            await people.enroll(connection, [("ana", None, "Ana Ba Dü", None, None, None, "Ba Dü")])
            await people.enroll(connection, [("ana", None, "Ana Ba Dü", "ana@x.org")])
        return await people.everybody(database)

    names = [row.name for row in run(database_url, enter)]
    assert names == ["änne", "ana", *(name for name, _ in IN_ORDER[1:])]
    assert sql(database_url, "SELECT sort_key FROM person WHERE name = 'ana'") == [("ba du\tana",)]
