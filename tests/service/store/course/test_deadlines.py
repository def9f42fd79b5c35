"""Extensions of many people and assignments at once."""

from datetime import UTC, datetime, timedelta

import pytest

from service.store.course import assignment_settings, deadlines
from tests.support.database import entered, run, sql

DUE = datetime(2099, 3, 1, 12, tzinfo=UTC)
DAY = timedelta(days=1)
SLUGS = ["rigid-body", "waves", "integrators"]
NAMES = ["ann", "ben", "cleo"]


@pytest.fixture
def url(database_url):
    """Three students; integrators has no deadline, and waves is due a day after rigid-body."""
    for name in NAMES:
        entered(database_url, name)

    async def set_deadlines(database):
        for slug, due in (("rigid-body", DUE), ("waves", DUE + DAY)):
            await assignment_settings.change(database, slug, {"due_at": due}, "prof")

    run(database_url, set_deadlines)
    return database_url


def extend(url, names=NAMES, slugs=SLUGS, *, due_at=None, later=timedelta(0)):
    given = {"due_at": due_at, "later": later, "reason": "the server was down", "by": "prof"}
    return run(url, lambda database: deadlines.extend_many(database, slugs, names, **given))


def stored(url):
    rows = run(url, deadlines.all_extensions)
    return {(row.slug, row.name): row.due_at - DUE for row in rows}


def test_each_deadline_is_later_by_as_much_and_what_has_none_is_left_out(url):
    assert extend(url, later=2 * DAY) == 6
    expected = {
        (slug, name): days * DAY for slug, days in (("rigid-body", 2), ("waves", 3)) for name in NAMES
    }
    assert stored(url) == expected
    own = run(url, lambda database: deadlines.own(database, "waves", "ben"))
    assert own.extended and own.due_at == DUE + 3 * DAY


def test_nobody_gets_less_time(url):
    assert extend(url, ["ann"], ["rigid-body"], later=5 * DAY) == 1
    assert extend(url, later=2 * DAY) == 5
    assert stored(url)["rigid-body", "ann"] == 5 * DAY
    assert extend(url, due_at=DUE + DAY / 2) == 0, "earlier than what they have"
    assert extend(url, later=timedelta(0)) == 0


def test_one_time_for_all(url):
    assert extend(url, due_at=DUE + 4 * DAY) == 6
    assert set(stored(url).values()) == {4 * DAY}


def test_every_person_finds_it_in_the_audit_log(url):
    extend(url, ["ann", "ben"], ["rigid-body"], later=DAY)
    entries = "SELECT actor, subject, detail->>'assignment' FROM audit WHERE action = %s ORDER BY id"
    both = [("prof", "ann", "rigid-body"), ("prof", "ben", "rigid-body")]
    assert sql(url, entries, "extension") == both
    removed = run(url, lambda database: deadlines.remove_many(database, SLUGS, NAMES, "prof"))
    assert removed == 2 and stored(url) == {} and sql(url, entries, "extension taken back") == both
    last = run(url, lambda database: deadlines.removed_extension(database, "rigid-body", "ann"))
    assert last.due_at == DUE + DAY and last.reason == "the server was down"


def test_who_is_not_in_the_course_and_what_does_not_exist_is_left_out(url):
    assert extend(url, ["ann", "nobody"], ["rigid-body", "nothing"], later=DAY) == 1
