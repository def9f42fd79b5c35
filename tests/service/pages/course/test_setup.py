"""The page that leads through the set-up of a course, and its forms."""

import re
from datetime import UTC, datetime, timedelta

import pytest

from tests.support.database import entered, new_database, sql

DUE = "2099-03-01T12:00"


@pytest.fixture(scope="module")
def url(postgres):
    url = new_database(postgres.url, "polhode")
    entered(url, "prof", "instructor")
    entered(url, "helper", "assistant")
    return url


@pytest.fixture
def drafts(url):
    """All assignments are drafts without dates."""
    sql(url, "UPDATE assignment SET published = false, due_at = NULL, available_from = NULL")


def settings(url, slug="rigid-body"):
    of = "SELECT published, available_from, due_at FROM assignment WHERE slug = %s"
    return sql(url, of, slug)[0]


def test_it_says_what_is_done(looks, url, drafts):
    page = looks("prof", "/setup")[1]
    assert "✓ 2 people" in page and "all are drafts" in page and "no name yet" in page
    assert page.count("nobody yet") == 1 and "nothing submitted yet" in page
    entered(url, "ann", "student")
    assert "✓ 1 student" in looks("prof", "/setup")[1]
    sql(url, "DELETE FROM member USING person p WHERE p.id = person_id AND p.name = 'ann'")


def test_the_front_page_leads_there_until_something_is_published_and_somebody_in_the_course(
    looks, url, drafts
):
    assert "No assignment is published yet" in looks("prof", "/")[1]
    sql(url, "UPDATE assignment SET published = true WHERE slug = 'waves'")
    assert "No student is in the course yet" in looks("helper", "/")[1]
    entered(url, "ann", "student")
    assert "/setup" not in looks("prof", "/")[1] and "/setup" not in looks("ann", "/")[1]
    sql(url, "DELETE FROM member USING person p WHERE p.id = person_id AND p.name = 'ann'")


def test_the_course_gets_name_term_and_zone_and_keeps_its_penalty(looks, url):
    sql(url, "UPDATE course SET late_penalty = 0.25")
    fields = {"title": "Tops & Spins", "term": "Winter", "time_zone": "Europe/Berlin"}
    assert looks("prof", "/setup/course", at="/setup", **fields)[0] == 200
    stored = "SELECT title, term, time_zone, late_penalty FROM course"
    assert sql(url, stored) == [(*fields.values(), 0.25)]
    status, page, _ = looks("prof", "/setup/course", at="/setup", **fields | {"time_zone": "Mars"})
    assert status == 422 and "no time zone Mars" in page
    sql(url, "UPDATE course SET title = '', term = '', time_zone = 'UTC', late_penalty = 0")


def test_what_is_ticked_is_published_with_its_dates(looks, url, drafts):
    shown = looks("prof", "/setup")[1]
    chosen = {"published-rigid-body": "yes", "due-rigid-body": DUE, "available-rigid-body": ""}
    chosen |= {"due-waves": "", "available-waves": "2099-01-01T08:00"}
    assert 'name="published-rigid-body" value="yes" checked' not in shown
    assert looks("prof", "/setup/assignments", at="/setup", **chosen)[0] == 200
    assert settings(url) == (True, None, datetime(2099, 3, 1, 12, tzinfo=UTC))
    assert settings(url, "waves") == (False, datetime(2099, 1, 1, 8, tzinfo=UTC), None)
    assert settings(url, "integrators") == (False, None, None), "a form without it leaves it as it is"
    del chosen["published-rigid-body"]
    looks("prof", "/setup/assignments", at="/setup", **chosen)
    assert settings(url)[0] is False


def test_a_form_that_was_open_meanwhile_undoes_nothing(looks, url, drafts):
    page = looks("prof", "/setup")[1]
    hidden = re.findall(r'<input type="hidden" name="(seen-[\w-]+)" value="([^"]*)">', page)
    fields = {name.removeprefix("seen-"): value for name, value in hidden}
    assert fields["waves"] == "||" and fields["time_zone"] == "UTC" and fields["title"] == ""
    sql(url, "UPDATE assignment SET published = true, due_at = %s WHERE slug = 'waves'", f"{DUE}Z")
    sql(url, "UPDATE course SET title = 'Tops'")
    chosen = {f"available-{slug}": "" for slug in ("waves", "rigid-body")}
    chosen |= {"due-waves": "", "published-rigid-body": "yes", "due-rigid-body": "", **dict(hidden)}
    chosen |= {"available-waves": "2099-01-01T08:00"}
    assert looks("prof", "/setup/assignments", at="/setup", **chosen)[0] == 200
    assert settings(url)[0] and settings(url, "waves") == (
        True,
        datetime(2099, 1, 1, 8, tzinfo=UTC),
        datetime(2099, 3, 1, 12, tzinfo=UTC),
    )
    course = {"title": "", "term": "Winter", "time_zone": "UTC", **dict(hidden)}
    assert looks("prof", "/setup/course", at="/setup", **course)[0] == 200
    assert sql(url, "SELECT title, term FROM course") == [("Tops", "Winter")]
    sql(url, "UPDATE course SET title = '', term = ''")


def test_a_deadline_in_the_past_asks(looks, url, drafts):
    past = (datetime.now(UTC) - timedelta(days=1)).strftime("%Y-%m-%dT%H:%M")
    fields = {"published-rigid-body": "yes", "due-rigid-body": past, "due-waves": DUE}
    status, page, _ = looks("prof", "/setup/assignments", at="/setup", **fields)
    assert status == 422 and "this deadline is past" in page and f'value="{past}"' in page
    assert re.search(r'data-asks="due-">', page), "the box to tick is shown"
    assert settings(url) == settings(url, "waves") == (False, None, None)
    assert looks("prof", "/setup/assignments", at="/setup", past="yes", **fields)[0] == 200
    assert settings(url)[0] is True and settings(url)[2] < datetime.now(UTC)
    assert looks("prof", "/setup/assignments", at="/setup", **fields)[0] == 200, "it is the stored one now"
    assert re.search(r'data-asks="due-" hidden', looks("prof", "/setup")[1])


def test_assistants_see_it_and_change_nothing(looks, url):
    status, page, _ = looks("helper", "/setup")
    assert status == 200 and "Only instructors can change it" in page
    assert "Save" not in page and "<input disabled" in page
    assert looks("helper", "/setup/course", at="/setup", title="x", time_zone="UTC")[0] == 403
