"""The link that creates the first instructor: the same on all servers, and good for one use."""

import asyncio

import pytest

from service.store.people import first_instructor, people
from tests.support.database import entered, run, sql


def link_secret(url, *, single_user=False):
    return run(url, lambda database: first_instructor.link_secret(database, single_user=single_user))


def is_needed(url, *, single_user=False):
    return run(url, lambda database: first_instructor.is_needed(database, single_user=single_user))


def create(url, secret, name="emmy", password=None, *, single_user=False):
    async def in_transaction(database):
        async with database.begin() as connection:
            await first_instructor.create(
                connection, secret, name, "Emmy Noether", password, single_user=single_user
            )

    run(url, in_transaction)


def test_the_link_is_the_same_until_it_is_used(database_url):
    secret = link_secret(database_url)
    assert secret == link_secret(database_url) and len(secret) > 40
    assert is_needed(database_url)
    create(database_url, secret, password="a hash")
    assert not is_needed(database_url)
    assert link_secret(database_url) is None
    found = "SELECT m.role, p.full_name, p.password FROM member m JOIN person p ON p.id = m.person_id"
    assert sql(database_url, f"{found} WHERE p.name = 'emmy'") == [("instructor", "Emmy Noether", "a hash")]
    with pytest.raises(first_instructor.LinkOver):
        create(database_url, secret, "mallory")


def test_people_log_in_once_it_was_used(database_url):
    assert not run(database_url, first_instructor.people_log_in)
    create(database_url, link_secret(database_url))
    assert run(database_url, first_instructor.people_log_in)


@pytest.mark.parametrize("secret", ["", "wrong", "first instructor"])
def test_another_secret_creates_nobody(database_url, secret):
    link_secret(database_url)
    with pytest.raises(first_instructor.LinkOver):
        create(database_url, secret)
    assert is_needed(database_url)


def test_an_imported_instructor_ends_the_link(database_url):
    secret = link_secret(database_url)

    async def enroll(database):
        async with database.begin() as connection:
            await people.enroll(connection, [("prof", "instructor")])

    run(database_url, enroll)
    with pytest.raises(first_instructor.LinkOver):
        create(database_url, secret)
    assert link_secret(database_url) is None
    assert sql(database_url, "SELECT count(*) FROM secret WHERE name = 'first instructor'") == [(0,)]


def test_without_logins_the_link_lasts_until_it_is_used_also_beside_an_imported_instructor(database_url):
    secret = link_secret(database_url, single_user=True)
    entered(database_url, "prof", "instructor")
    assert link_secret(database_url, single_user=True) == secret
    create(database_url, secret, "prof", "a hash", single_user=True)
    assert run(database_url, first_instructor.people_log_in)
    assert link_secret(database_url, single_user=True) is None
    assert not is_needed(database_url, single_user=True)


def test_of_two_at_once_one_becomes_it(database_url):
    secret = link_secret(database_url)

    async def attempt(database, name):
        async with database.begin() as connection:
            await first_instructor.create(connection, secret, name, None, None, single_user=False)

    async def both(database):
        attempts = [attempt(database, name) for name in ("emmy", "mallory")]
        return await asyncio.gather(*attempts, return_exceptions=True)

    results = run(database_url, both)
    assert sorted(type(result).__name__ for result in results) == ["LinkOver", "NoneType"]
