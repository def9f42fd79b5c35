"""Adding and changing single people: two at once, the last instructor, what the audit log gets."""

import asyncio

import pytest

from service.store.people import editing, people
from tests.support.database import entered, run, sql

BEN = {"role": "student", "full_name": "Ben Ek", "email": "ben@x.org", "student_id": "42", "section": "A"}


@pytest.fixture
def url(database_url):
    """A course with the instructor prof and the student ben."""
    entered(database_url, "prof", "instructor")
    add(database_url, "ben", BEN)
    return database_url


def add(url, name, values):
    async def in_transaction(database):
        async with database.begin() as connection:
            await editing.add(connection, name, values, "prof")

    run(url, in_transaction)


async def changed(database, name, values, seen, by="prof"):
    async with database.begin() as connection:
        await editing.change(connection, name, values, seen, by)


def change(url, name, values, seen, by="prof"):
    run(url, lambda database: changed(database, name, values, seen, by))


def stored(url, name):
    row = run(url, lambda database: people.find(database, name))
    return {field: getattr(row, field) for field in editing.FIELDS}


def log(url, action):
    return sql(url, "SELECT actor, subject, detail FROM audit WHERE action = %s ORDER BY id", action)


def test_a_person_is_added_once(url):
    assert stored(url, "ben") == BEN and log(url, "add person") == [("prof", "ben", BEN)]
    with pytest.raises(editing.KnownPerson):
        add(url, "ben", BEN | {"role": "instructor"})
    assert stored(url, "ben") == BEN


def test_what_differs_is_changed_and_logged_with_old_and_new_value(url):
    new = BEN | {"email": "", "section": "B"}
    change(url, "ben", new, BEN)
    assert stored(url, "ben") == new
    changed = {"email": {"old": "ben@x.org", "new": ""}, "section": {"old": "A", "new": "B"}}
    assert log(url, "person") == [("prof", "ben", changed)]
    change(url, "ben", new, new)
    assert len(log(url, "person")) == 1, "nothing was changed"


def test_another_name_sorts_elsewhere(url):
    key = "SELECT sort_key FROM person WHERE name = 'ben'"
    assert sql(url, key)[0][0].startswith("ek")
    change(url, "ben", BEN | {"full_name": "Ben Ågård"}, BEN)
    assert sql(url, key)[0][0].startswith("agard")


def test_the_second_of_two_learns_what_the_first_has_changed(url):
    change(url, "ben", BEN | {"section": "B"}, BEN, by="helper")
    with pytest.raises(editing.ChangedMeanwhile) as meanwhile:
        change(url, "ben", BEN | {"email": "new@x.org"}, BEN)
    assert meanwhile.value.changes == {"section": ("A", "B")} and meanwhile.value.by == "helper"
    assert stored(url, "ben") == BEN | {"section": "B"}
    change(url, "ben", BEN | {"section": "B", "email": "new@x.org"}, BEN | {"section": "B"})
    assert stored(url, "ben") == BEN | {"section": "B", "email": "new@x.org"}


def test_a_change_by_an_import_has_no_name(database_url):
    entered(database_url, "ann", "student")
    seen = stored(database_url, "ann")
    sql(database_url, "UPDATE person SET email = 'ann@x.org' WHERE name = 'ann'")
    with pytest.raises(editing.ChangedMeanwhile) as meanwhile:
        change(database_url, "ann", seen, seen)
    assert meanwhile.value.by == ""


@pytest.mark.parametrize("role", ["student", "assistant", "former"])
def test_the_last_instructor_stays_one(url, role):
    prof = stored(url, "prof")
    with pytest.raises(editing.LastInstructor):
        change(url, "prof", prof | {"role": role, "email": "prof@x.org"}, prof)
    assert stored(url, "prof") == prof
    change(url, "prof", prof | {"email": "prof@x.org"}, prof)
    change(url, "ben", BEN | {"role": "instructor"}, BEN)
    change(url, "prof", prof | {"role": role, "email": "prof@x.org"}, prof | {"email": "prof@x.org"})
    assert stored(url, "prof")["role"] == role


def test_two_instructors_cannot_remove_each_other_at_once(url):
    entered(url, "emmy", "instructor")
    seen = stored(url, "prof")

    async def both(database):
        attempts = [
            changed(database, name, seen | {"role": "student"}, seen, by)
            for name, by in (("prof", "emmy"), ("emmy", "prof"))
        ]
        return await asyncio.gather(*attempts, return_exceptions=True)

    assert sorted(type(one).__name__ for one in run(url, both)) == ["LastInstructor", "NoneType"]
