"""The form behind the printed link: it creates the first instructor, who is logged in, and works once."""

from functools import partial

import pytest

from service.auth.passwords import PasswordChecker
from service.store.people import first_instructor, people
from tests.support.database import entered, run, sql
from tests.support.http_client import Browser

PASSWORD = "correct horse battery"
FIELDS = {"name": "emmy", "full_name": "Emmy Noether", "password": PASSWORD, "again": PASSWORD}


@pytest.fixture
def link(database_url):
    return run(database_url, partial(first_instructor.link_secret, single_user=True))


@pytest.fixture(params=["local", "token"])
def course(request, new_app, database_url, cheap_hashes):
    """A server on an empty database, with and without logins."""
    return new_app(database_url=database_url, identity=request.param)


def test_the_link_makes_an_instructor_and_from_then_on_people_log_in(course, link):
    browser, stranger = Browser(course), Browser(course)
    status, page = browser.open("/start")
    assert status == 200 and "Start a course" in page
    status, page = browser.send("/start", page="/start", token=link, **FIELDS)
    assert (status, browser.at) == (200, "/setup") and "emmy, instructor" in page
    assert "emmy" in page and "Nobody logs in" not in page
    assert stranger.open("/")[0] == 200 and stranger.at == "/login"
    assert stranger.open("/v1/me")[0] == 401
    assert stranger.log_in(name="emmy", password=PASSWORD).open("/setup")[0] == 200
    assert stranger.open("/start")[0] == 200 and stranger.at == "/setup", "there is one now"
    status, page = Browser(course).send("/start", page="/login", token=link, **FIELDS | {"name": "mallory"})
    assert status == 403 and "or it was used" in page


WRONG = {
    "token": ({"token": "wrong"}, 403, "not the link that the server printed"),
    "no token": ({"token": ""}, 422, "enter the token"),
    "name": ({"name": " "}, 422, "a name must have"),
    "local": ({"name": "local"}, 422, "enter another one"),
    "short": ({"password": "x", "again": "x"}, 422, "10 to 200 characters"),
    "again": ({"again": "something else"}, 422, "passwords do not match"),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_a_wrong_field_keeps_what_was_typed_and_creates_nobody(new_app, database_url, link, wrong):
    fields, expected, sentence = WRONG[wrong]
    browser = Browser(new_app(database_url=database_url))
    status, page = browser.send("/start", page="/start", **{"token": link, **FIELDS} | fields)
    assert status == expected and sentence in page and 'value="Emmy Noether"' in page
    assert not run(database_url, first_instructor.people_log_in)
    assert sql(database_url, "SELECT count(*) FROM person WHERE name <> 'local'") == [(0,)]


def test_a_wrong_link_costs_no_hash(new_app, database_url, link, monkeypatch):
    async def hash(self, password):
        raise AssertionError("hashed")

    monkeypatch.setattr(PasswordChecker, "hash", hash)
    browser = Browser(new_app(database_url=database_url))
    assert browser.send("/start", page="/start", token="wrong", **FIELDS)[0] == 403


def test_who_is_logged_in_becomes_it_themselves(new_app, database_url, link):
    app = new_app(database_url=database_url, person_header="Remote-User")
    browser = Browser(app, Remote_User="emmy")
    page = browser.open("/start")[1]
    assert "You are logged in as <b>emmy</b>" in page and 'name="password"' not in page
    assert browser.open("/setup")[0] == 403
    assert browser.send("/start", page="/start", token=link)[0] == 200 and browser.at == "/setup"
    assert run(database_url, lambda database: people.role(database, "emmy")) == "instructor"


def test_who_views_as_a_student_makes_nobody_an_instructor(new_app, database_url, link):
    for name, role in (("helper", "assistant"), ("ben", "student")):
        entered(database_url, name, role)
    browser = Browser(new_app(database_url=database_url, person_header="Remote-User"), Remote_User="helper")
    assert browser.send("/person/view?name=ben", page="/")[0] == 200
    status, page = browser.send("/start", page="/start", token=link)
    assert status == 403 and "you see the pages as ben does" in page
    assert run(database_url, lambda database: people.role(database, "ben")) == "student"


def test_a_server_for_one_person_stays_as_it_is_without_the_link(new_app, database_url, link):
    app = new_app(database_url=database_url, identity="local")
    entered(database_url, "prof", "instructor")
    browser = Browser(app)
    status, page = browser.open("/setup")
    assert status == 200 and "Nobody logs in" in page
    fields = FIELDS | {"name": "prof", "full_name": ""}
    assert browser.send("/start", page="/start", token=link, **fields)[0] == 200 and browser.at == "/setup"
    assert Browser(app).open("/v1/me")[0] == 401, "from then on people log in"
