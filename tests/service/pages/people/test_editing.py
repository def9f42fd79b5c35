"""Adding and editing people on pages: two at once, tokens and passwords that are shown once, extensions."""

import re
from datetime import UTC, datetime, timedelta
from html import unescape

import pytest

from tests.support.database import entered, new_database, sql
from tests.support.http_client import Browser, call

BEN = {"full_name": "Ben Ek", "email": "ben@x.org", "student_id": "42", "section": "A", "role": "student"}
PAGE = "/person?name=ben"


@pytest.fixture(scope="module")
def url(postgres):
    url = new_database(postgres.url, "polhode")
    for name, role in (("prof", "instructor"), ("helper", "assistant"), ("emmy", "instructor")):
        entered(url, name, role)
    return url


@pytest.fixture
def ben(looks, url):
    """Ben is in the course with the values of BEN."""
    if looks("prof", PAGE)[0] == 404:
        looks("prof", "/people/add", at="/people/add", name="ben", **BEN)
    sql(url, "UPDATE person SET full_name = 'Ben Ek', email = 'ben@x.org', student_id = '42', section = 'A'")
    entered(url, "ben", "student")


def stored(url, name="ben"):
    of = "SELECT p.full_name, p.email, p.student_id, p.section, m.role FROM person p JOIN member m ON"
    rows = sql(url, f"{of} m.person_id = p.id WHERE p.name = %s", name)
    return dict(zip(BEN, rows[0], strict=True)) if rows else None


def form(page):
    """What the form that edits a person shows."""
    edit = page.partition('<details id="edit"')[2].partition("</form>")[0]
    shown = {
        name: unescape(value) for name, value in re.findall(r'name="([\w-]+)"[^>]*? value="([^"]*)"', edit)
    }
    shown["role"] = re.search(r"<option selected>(\w+)", edit)[1]
    del shown["csrf"]
    return shown


def edit(looks, who, shown, **changes):
    return looks(who, f"/person/edit?{PAGE.partition('?')[2]}", at=PAGE, **shown | changes)[:2]


def test_a_person_is_added_with_a_token_that_is_shown_once(server, looks, url):
    status, page, _ = looks("prof", "/people/add", at="/people/add", name="fay", token="yes", **BEN)
    token = re.search(r'id="secret"[^>]*>(polhode_[\w-]+)<', page)[1]
    assert status == 200 and f"{server.url}/login#token={token}" in page
    assert stored(url, "fay") == BEN
    assert Browser(server).log_in(token=token).open("/account")[0] == 200
    assert token not in looks("prof", "/person?name=fay")[1]
    assert "<td>student, A</td>" in looks("helper", "/people")[1], "her section"


def test_without_a_token_the_persons_page_follows(looks, url):
    status, page, _ = looks(
        "prof", "/people/add", at="/people/add", name=" Zoë Å ", **BEN | {"role": "assistant"}
    )
    assert status == 200 and "<h1>Ben Ek</h1>" in page and stored(url, "Zoë Å")["role"] == "assistant"


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"name": " "}, "a name must have 1 to 200"),
        ({"name": "local"}, "polhode&#39;s own"),
        ({"name": "prof"}, "prof is in the course already"),
        ({"role": "boss"}, "choose one of student, assistant"),
        ({"email": "a\x07b"}, "the email has a character"),
        ({"section": "x" * 201}, "section is too long"),
    ],
)
def test_a_person_who_cannot_be_added_is_not(looks, url, fields, sentence):
    people = sql(url, "SELECT count(*) FROM person")
    typed = {"name": "gus", **BEN} | fields
    status, page, _ = looks("prof", "/people/add", at="/people/add", **typed)
    assert status == 422 and sentence in page and 'value="42"' in page
    assert sql(url, "SELECT count(*) FROM person") == people


def test_a_person_is_edited(looks, url, ben):
    shown = form(looks("prof", PAGE)[1])
    assert {name: shown[name] for name in BEN} == BEN
    status, page = edit(looks, "prof", shown, full_name="  Ben   Ågård ", section="", role="assistant")
    assert status == 200 and "<h1>Ben Ågård</h1>" in page
    assert stored(url) == BEN | {"full_name": "Ben Ågård", "section": "", "role": "assistant"}


def test_of_two_who_edit_a_person_the_second_sees_what_changed_and_loses_nothing(looks, url, ben):
    first, second = (form(looks(who, PAGE)[1]) for who in ("prof", "emmy"))
    assert edit(looks, "prof", first, email="new@x.org", role="former")[0] == 200
    status, page = edit(looks, "emmy", second, full_name="Benjamin Ek", section="B")
    assert status == 409 and stored(url) == BEN | {"email": "new@x.org", "role": "former"}
    assert "prof has changed this person" in page
    assert "role from student to former, email from ben@x.org to new@x.org" in page
    shown = form(page)
    typed = {"full_name": "Benjamin Ek", "section": "B"}
    assert {name: shown[name] for name in BEN} == BEN | typed | {"email": "new@x.org", "role": "former"}
    assert edit(looks, "emmy", shown)[0] == 200
    assert stored(url) == BEN | typed | {"email": "new@x.org", "role": "former"}


def test_two_who_change_the_same_field(looks, url, ben):
    first, second = (form(looks(who, PAGE)[1]) for who in ("prof", "emmy"))
    edit(looks, "prof", first, section="B")
    status, page = edit(looks, "emmy", second, section="C")
    assert status == 409 and "section from A to B" in page and form(page)["section"] == "C"
    edit(looks, "emmy", form(page))
    assert stored(url)["section"] == "C"


def test_the_last_instructor_stays_one(looks, url):
    sql(url, "UPDATE member SET role = 'student' FROM person p WHERE p.id = person_id AND p.name = 'emmy'")
    page = looks("prof", "/person?name=prof")[1]
    status, page, _ = looks(
        "prof", "/person/edit?name=prof", at="/person?name=prof", **form(page) | {"role": "student"}
    )
    assert status == 422 and "prof is the only instructor" in page
    entered(url, "emmy", "instructor")


def test_a_new_token_ends_what_was_before(server, looks, url, ben):
    old = entered(url, "ben", "student")
    browser = Browser(server).log_in(token=old)
    page = looks("prof", "/person/token?name=ben", at=PAGE)[1]
    new = re.search(r'id="secret"[^>]*>(polhode_[\w-]+)<', page)[1]
    statuses = [call(server, "/v1/me", Authorization=f"Bearer {token}")[0] for token in (old, new)]
    assert statuses == [401, 200]
    assert browser.open("/account")[0] == 200 and browser.at.startswith("/login")


def test_a_new_password_logs_in(server, looks, url, ben, cheap_hashes):
    browser = Browser(server).log_in(token=entered(url, "ben", "student"))
    page = looks("prof", "/person/password?name=ben", at=PAGE)[1]
    password = re.search(r'id="secret"[^>]*>([\w-]+)<', page)[1]
    assert len(password) > 12 and Browser(server).log_in(name="ben", password=password).cookie(
        "polhode_session"
    )
    assert browser.open("/account")[0] == 200 and browser.at.startswith("/login")
    assert sql(url, "SELECT actor FROM audit WHERE action = 'set password'") == [("prof",)]


def test_an_extension_is_given_and_removed_on_the_persons_page(looks, url, ben):
    sql(url, "UPDATE assignment SET due_at = '2099-03-01T12:00Z' WHERE slug = 'waves'")
    address = "/person/extensions?name=ben"
    given = {"assignment": "waves", "due": "2099-03-08T12:00", "reason": "was ill"}
    assert looks("prof", address, at=PAGE, **given)[0] == 200
    of = "SELECT due_at, reason, given_by FROM extension"
    assert sql(url, of) == [(datetime(2099, 3, 8, 12, tzinfo=UTC), "was ill", "prof")]
    assert "was ill" in looks("helper", PAGE)[1]
    past = (datetime.now(UTC) - timedelta(days=1)).strftime("%Y-%m-%dT%H:%M")
    for wrong, sentence in (
        ({"due": past}, "this deadline is past"),
        ({"reason": " "}, "enter the reason"),
        ({"assignment": "nothing"}, "choose an assignment"),
    ):
        status, page, _ = looks("prof", address, at=PAGE, **given | wrong)
        assert status == 422 and sentence in page, wrong
    assert looks("prof", address, at=PAGE, **given | {"due": ""})[0] == 200
    assert sql(url, of) == []
    assert looks("prof", address, at=PAGE, **given | {"due": ""})[0] == 422, "there is none to remove"


def test_assistants_see_no_forms_and_an_unknown_person_is_not_found(looks, url, ben):
    page = looks("helper", PAGE)[1]
    assert "/person/edit" not in page and "/person/token" not in page and "/person/extensions" not in page
    assert "/people/add" not in looks("helper", "/people")[1] and looks("helper", "/people/add")[0] == 403
    for path in ("edit", "token", "password", "extensions"):
        assert looks("prof", f"/person/{path}?name=nobody", at="/people", role="student")[0] == 404
