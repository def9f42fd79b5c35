"""Logging in and out with a browser: sessions, forms, passwords and how often they may be wrong, against a
real server.
"""

import json
import re
import time
import urllib.parse

import psycopg
import pytest

from service.auth import passwords
from tests.support.app import App
from tests.support.database import entered, sql
from tests.support.http_client import HIDDEN, Browser

pytestmark = pytest.mark.usefixtures("cheap_hashes")
PASSWORD = "correct horse battery"
HTTPS = {"X_Forwarded_Proto": "https"}


@pytest.fixture(scope="module")
def server(url):
    started = App(database_url=url, log_level="info")
    yield started
    started.stop()


@pytest.fixture(scope="module")
def second(url):
    """Another server on the same database."""
    started = App(database_url=url)
    yield started
    started.stop()


def sessions(url, name):
    asked = (
        "SELECT count(*) FROM token t JOIN person p ON p.id = t.person_id WHERE p.name = %s AND"
        " starts_with(prefix, 'session_')"
    )
    return sql(url, asked + " AND revoked_at IS NULL", name)[0][0]


def from_address(server, address, **headers):
    """A browser as a proxy on this machine tells of it."""
    return Browser(server, X_Forwarded_For=address, **headers)


def test_a_password_logs_in_and_leads_back_to_where_they_were_going(server, url):
    entered(url, "ann", password=PASSWORD)
    browser = Browser(server)
    browser.open("/assignments/rigid-body?x=1")
    assert browser.at == "/login?next=/assignments/rigid-body%3Fx%3D1"
    status, page = browser.send(browser.at, browser.at, name=" ann ", password=PASSWORD)
    assert status == 200 and browser.at == "/assignments/rigid-body?x=1" and "ann" in page
    assert sql(url, "SELECT action, subject FROM audit WHERE actor = 'ann'") == [("log in", "ann")]


@pytest.mark.parametrize(
    "path",
    [
        "//evil.example",
        "/\\evil.example",
        "\\/evil.example",
        "https://evil.example/",
        "javascript:alert(1)",
        "/\t/evil.example",
        "/\n/evil.example",
        "evil.example",
        "///evil.example",
        "/ä",
        "/a b",
    ],
)
def test_nobody_is_led_elsewhere_after_logging_in(server, url, path):
    browser, login = Browser(server), f"/login?next={urllib.parse.quote(path)}"
    assert 'action="/login?code=&amp;next="' in browser.open(login)[1]
    assert browser.send(login, login, token=entered(url, "nia"))[0] == 200 and browser.at == "/"


def test_cookies_are_for_this_server_and_no_script(server, url):
    token = entered(url, "bea")
    for headers, secure in (({}, False), (HTTPS, True)):
        browser = Browser(server, **headers)
        browser.open("/login")
        visit, page = browser.cookie("polhode_visit"), browser.open("/login")[1]
        assert visit.has_nonstandard_attr("HttpOnly") and visit.secure == secure
        if secure:  # which this jar does not send back over http
            continue
        browser.open("/login", csrf=HIDDEN.search(page)[1], token=token)
        cookie = browser.cookie("polhode_session")
        assert (
            cookie.has_nonstandard_attr("HttpOnly")
            and cookie.get_nonstandard_attr("SameSite") == "lax"
            and not cookie.secure
        )
        assert abs(cookie.expires - time.time() - 12 * 3600) < 60 and browser.cookie("polhode_visit") is None
        secret = cookie.value.split(".")[0]
        assert secret.startswith("session_") and secret not in str(sql(url, "SELECT t::text FROM token t"))
        assert Browser(server, Authorization=f"Bearer {secret}").open("/v1/me")[0] == 401, (
            "a session is no token"
        )


def test_a_forged_cookie_is_nobodys_and_costs_no_query(server, url):
    browser = Browser(server).log_in(token=entered(url, "cas"))
    cookie = browser.cookie("polhode_session")
    good = cookie.value
    secret, stamp, signature = good.split(".")
    assert browser.open("/v1/me")[0] == 200
    with psycopg.connect(url) as connection:
        connection.execute("LOCK TABLE token IN ACCESS EXCLUSIVE MODE")  # whoever asks it now waits
        for forged in (
            secret,
            f"{secret}.{stamp}",
            f"{secret}.{stamp}.{signature[:-2]}AA",
            f"{secret}x.{stamp}.{signature}",
            ".",
            "",
        ):
            cookie.value, began = forged, time.monotonic()
            assert browser.open("/v1/me")[0] == 401 and time.monotonic() - began < 5, forged
    cookie.value = good
    assert browser.open("/v1/me")[0] == 200


def test_every_login_begins_another_session_and_ends_the_one_before(server, url):
    token, other = entered(url, "dag"), entered(url, "dot")
    browser = Browser(server).log_in(token=token)
    before = browser.cookie("polhode_session").value
    browser.send("/login", "/account", token=other)
    assert browser.cookie("polhode_session").value != before and ">dot</dd>" in browser.open("/account")[1]
    assert (sessions(url, "dag"), sessions(url, "dot")) == (0, 1)


def test_a_session_planted_before_is_not_the_one_after_logging_in(server, url):
    attacker = Browser(server).log_in(token=entered(url, "mal"))
    victim = Browser(server)
    for cookie in attacker.cookies:
        victim.cookies.set_cookie(cookie)
    victim.send("/login", "/account", token=entered(url, "vic"))
    assert ">vic</dd>" in victim.open("/account")[1]
    attacker.open("/account")
    assert attacker.at.startswith("/login"), "what was planted is over"


def test_logging_out_holds_on_every_server(server, second, url):
    browser = Browser(server).log_in(token=entered(url, "eda"))
    elsewhere = Browser(second)
    elsewhere.cookies = browser.cookies
    elsewhere._opener = browser._opener
    assert ">eda</dd>" in elsewhere.open("/account")[1]
    status, page = browser.send("/logout", "/account")
    assert (
        status == 200
        and "You are logged out" in page
        and browser.cookie("polhode_session") is None
        and sessions(url, "eda") == 0
    )


def test_a_session_is_over_after_its_time(server, url):
    browser = Browser(server).log_in(token=entered(url, "fin"))
    sql(url, "UPDATE token SET expires_at = now() - interval '1 s' WHERE starts_with(prefix, 'session_')")
    assert browser.open("/v1/me")[0] == 401


def test_forms_without_their_token_are_refused_also_before_login(server, url):
    token = entered(url, "gus")
    mine, theirs = Browser(server), Browser(server)
    page = theirs.open("/login")[1]
    assert mine.open("/login", token=token)[0] == 403, "no token, no visit"
    mine.open("/login")
    assert mine.open("/login", token=token, csrf=HIDDEN.search(page)[1])[0] == 403, (
        "the token of another visit"
    )
    assert mine.send("/login", origin="https://evil.example", token=token)[0] == 403
    assert sessions(url, "gus") == 0
    mine.log_in(token=token)
    before = HIDDEN.search(page)[1]
    for path in ("/account/password", "/account/revoke", "/account/logout-everywhere"):
        status, told = mine.open(path, csrf=before, id="x", password=PASSWORD, again=PASSWORD)
        assert status == 403 and "this form has expired" in told, path
        assert mine.open(path, x="1")[0] == 403, path
    for browser in (mine, theirs):  # with a session, and where no cookie came along
        assert browser.open("/logout", origin="https://evil.example", x="1")[0] == 403
    assert sessions(url, "gus") == 1


def test_who_is_at_home_alone_still_needs_the_token_of_the_form(new_app, database_url):
    server = new_app(database_url=database_url, identity="local")
    browser = Browser(server)
    assert (
        "no login is needed" in browser.open("/login")[1]
        and "no account is needed" in browser.open("/account")[1]
    )
    status, page = browser.open("/account/logout-everywhere", x="1")
    assert status == 403 and "this form has expired" in page


def test_wrong_names_and_passwords_get_one_answer_for_as_much_work(server, url, monkeypatch):
    entered(url, "hal", password=PASSWORD), entered(url, "ida")
    checked, matches = [], passwords.matches
    monkeypatch.setattr(
        passwords, "matches", lambda kept, guess: checked.append(guess) or matches(kept, guess)
    )
    answers = set()
    for name in ("hal", "ida", "nobody at all", "\x07", "hal' --"):
        browser = from_address(server, "10.9.0.1")
        browser.open("/login")
        page = browser.open("/login")[1]
        status, told = browser.open(
            "/login", csrf=HIDDEN.search(page)[1], name=name, password=f"wrong for {name}"
        )
        assert status == 401 and "name or password is wrong" in told and 'role="alert"' in told, name
        assert checked.pop() == f"wrong for {name}" and not checked, (
            "one computation for each, see test_passwords"
        )
        answers.add(re.search(r'role="alert".*?</p>', told, re.DOTALL)[0])
    assert len(answers) == 1
    assert PASSWORD not in server.log.read_text() and "wrong for" not in server.log.read_text()


def test_an_empty_login_says_what_to_enter(server):
    browser = from_address(server, "10.9.0.3")
    status, told = browser.open("/login", csrf=HIDDEN.search(browser.open("/login")[1])[1])
    assert (
        status == 401
        and "enter your name and password, or a token from your course" in told
        and "polhode.login" not in told
    )


def test_guessing_is_stopped_for_the_name_and_for_nobody_else(server, url):
    entered(url, "jon", password=PASSWORD), entered(url, "kim", password=PASSWORD)
    own = from_address(server, "10.1.0.1").log_in(name="jon", password=PASSWORD)  # his own browser
    own.send("/logout")
    statuses = [
        from_address(server, f"10.2.{n}.1").send("/login", name="jon", password=f"guess number {n}")[0]
        for n in range(12)
    ]
    assert statuses == [401] * 10 + [429] * 2
    guesser = from_address(server, "10.2.0.1")
    status, page = guesser.send("/login", name="jon", password=PASSWORD)
    assert status == 429 and 0 < int(guesser.answer["retry-after"]) <= 15 * 60
    assert re.search(r"too many failed logins: wait 1[0-5] minutes, or log in with the token", page)
    assert own.send("/login", name="jon", password=PASSWORD)[0] == 200, "where he has logged in before"
    assert from_address(server, "10.3.0.1").send("/login", token=entered(url, "jon"))[0] == 200, (
        "and anywhere with a token"
    )
    assert guesser.send("/login", name="kim", password=PASSWORD)[0] == 200, "others as ever"
    status, problem = from_address(server, "10.3.0.2", Accept="application/json").send(
        "/login", name="jon", password=PASSWORD
    )
    assert status == 429 and json.loads(problem)["type"] == "urn:polhode:problem:too-many"


def unknown_codes(count):
    for n in range(count):
        yield "/login?code=" + "".join("BCDFGHJKLM"[int(digit)] for digit in f"{n:08}")


def test_codes_of_notebooks_cannot_be_guessed_without_limit_by_a_person(server, url):
    ned = from_address(server, "10.5.0.1", Accept="application/json").log_in(token=entered(url, "ned"))
    asked = json.loads(from_address(server, "10.5.0.9").open("/v1/logins", label="mine")[1])
    confirm = {"csrf": HIDDEN.search(ned.open(f"/login?code={asked['user_code']}")[1])[1]}
    assert [ned.open(code, **confirm)[0] for code in unknown_codes(12)] == [404] * 10 + [429] * 2
    status, told = ned.open(f"/login?code={asked['user_code']}", **confirm)
    assert status == 429 and "too many unknown codes: wait 1" in told, "he cannot tell whether it is known"
    assert ned.open("/account")[0] == 200
    moved = from_address(server, "10.5.0.2").log_in(token=entered(url, "ned"))
    assert moved.open(f"/login?code={asked['user_code']}")[0] == 429, "the person, at any address"
    other = from_address(server, "10.5.0.1").log_in(token=entered(url, "ola"))
    assert "authorized as ola" in other.send(*[f"/login?code={asked['user_code']}"] * 2)[1]


def test_codes_of_notebooks_cannot_be_guessed_without_limit_by_nobody_either(server):
    browser = from_address(server, "10.6.0.1")
    assert [browser.open(code)[0] for code in unknown_codes(102)] == [200] * 100 + [429] * 2
    assert browser.open("/login")[0] == 200
    assert from_address(server, "10.6.0.2").open(next(unknown_codes(1)))[0] == 200


def test_a_known_browser_may_not_guess_forever_either(server, url):
    entered(url, "lea", password=PASSWORD)
    own = from_address(server, "10.4.0.1").log_in(name="lea", password=PASSWORD)
    own.send("/logout")
    assert [own.send("/login", name="lea", password="wrong password")[0] for _ in range(11)] == [401] * 10 + [
        429
    ]
    assert from_address(server, "10.4.0.1").send("/login", name="lea", password=PASSWORD)[0] == 200


def test_a_password_that_was_kept_with_other_parameters_is_kept_anew(server, url):
    from argon2 import PasswordHasher

    entered(url, "moe")
    before = PasswordHasher(time_cost=2, memory_cost=16, parallelism=1).hash(PASSWORD)
    sql(url, "UPDATE person SET password = %s WHERE name = 'moe'", before)
    Browser(server).log_in(name="moe", password=PASSWORD)
    kept = sql(url, "SELECT password FROM person WHERE name = 'moe'")[0][0]
    assert kept != before and not passwords.needs_rehash(kept) and passwords.matches(kept, PASSWORD)
    sql(url, "UPDATE person SET password = 'no hash' WHERE name = 'moe'")
    assert Browser(server).send("/login", name="moe", password=PASSWORD)[0] == 401
