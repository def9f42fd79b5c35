"""Who asks: tokens, logins confirmed in a browser, cookies and the hub, each against a real server."""

import asyncio
import contextlib
import csv
import json
import os
import re
import subprocess
import sys
import urllib.error
import urllib.request
from pathlib import Path

import pytest
from fastapi import Request
from itsdangerous import TimestampSigner
from limits import RateLimitItemPerMinute

from service.auth import rate_limit
from service.auth.identity import same_origin
from service.cli.__main__ import main
from service.http.errors import Problem
from service.settings import Settings
from service.store.people import people, tokens
from tests.support.app import App
from tests.support.database import entered, run, sql
from tests.support.http_client import Browser
from tests.support.hub import ADVISED

OPERATING = Path(__file__).parents[3] / "docs/operating.md"
SLUG = "/v1/assignments/rigid-body/submissions"
ZEROS = json.dumps({"source": "def euler_eqs(t, w, I):\n    return [0.0, 0.0, 0.0]\n"}).encode()


@pytest.fixture(scope="module")
def server(url, hub):
    """It wants a token from everybody and takes those of the hub."""
    started = App(database_url=url, POLHODE_HUB_API_URL=hub.api_url, origins="https://lite.example")
    yield started
    started.stop()


def call(server, path, body=None, token=None, method=None, scheme="Bearer", **headers):
    given = {name.replace("_", "-"): value for name, value in headers.items()} | (
        {"Content-Type": "application/json"} if body else {}
    )
    given |= {"Authorization": f"{scheme} {token}"} if token else {}
    try:
        with urllib.request.urlopen(
            urllib.request.Request(server.url + path, body, given, method=method), timeout=30
        ) as answer:
            return answer.status, json.loads(answer.read() or b"null"), answer.headers
    except urllib.error.HTTPError as error:
        with error:
            return error.code, json.loads(error.read() or b"null"), error.headers


def given(url, name, scopes=tokens.SCOPES, seconds=1000.0):
    return run(
        url,
        inside(
            lambda connection: tokens.create(connection, name, label="test", scopes=scopes, seconds=seconds)
        ),
    )


def inside(action):
    """``action`` of a connection as one of a database, in a transaction."""

    async def begun(database):
        async with database.begin() as connection:
            return await action(connection)

    return begun


def kind(told):
    return told[0], told[1]["type"].rpartition(":")[2], told[1]["detail"]


def test_nobody_gets_in_without_a_good_token(server, url):
    good, old = given(url, "ann"), given(url, "ann", seconds=-1.0)
    assert call(server, SLUG, ZEROS, good)[0] == call(server, SLUG, ZEROS, good, scheme="token")[0] == 202
    assert kind(call(server, SLUG, ZEROS))[:2] == (401, "nobody")
    assert kind(call(server, SLUG, ZEROS, "polhode_wrong")) == (
        401,
        "nobody",
        "this token is not valid here: check it, or log in again to get a new one",
    )
    assert "this token expired on 20" in kind(call(server, SLUG, ZEROS, old))[2]
    run(url, inside(lambda connection: tokens.revoke(connection, person="ann")))
    assert "this token was revoked on 20" in kind(call(server, SLUG, ZEROS, good))[2]


def test_a_token_is_kept_as_its_digest_only(server, url):
    token = given(url, "dora")
    rows = sql(url, "SELECT t::text FROM token t") + sql(url, "SELECT a::text FROM audit a")
    assert not any(token in row[0] or token[20:] in row[0] for row in rows)
    assert call(server, "/v1/me", token=token)[1] == {
        "person": "dora",
        "scopes": ["login", "read", "submit"],
        "local": False,
    }
    assert token not in server.log.read_text()


def test_a_student_has_a_number_of_waiting_submissions_and_staff_have_none(new_app, database_url):
    server = new_app(database_url=database_url, open_submissions=2)
    ann, ben, prof = (given(database_url, name) for name in ("ann", "ben", "prof"))
    run(database_url, inside(lambda connection: people.enroll(connection, [("prof", "assistant")])))
    assert [call(server, SLUG, ZEROS, ann)[0] for _ in range(3)] == [202, 202, 429]
    refused = call(server, SLUG, ZEROS, ann)
    assert kind(refused)[1] == "too-many-open" and "2 of your submissions" in kind(refused)[2]
    assert int(refused[2]["retry-after"]) > 0
    assert call(server, SLUG, ZEROS, ben)[0] == 202
    assert {call(server, SLUG, ZEROS, prof)[0] for _ in range(5)} == {202}


def test_users_who_share_a_server_without_logins_share_a_larger_number(new_app, database_url):
    server = new_app(database_url=database_url, open_submissions=1, identity="local")
    assert [call(server, SLUG, ZEROS)[0] for _ in range(11)] == [202] * 10 + [429]


def test_one_address_that_starts_many_logins_does_not_keep_others_from_logging_in(
    new_app, database_url, monkeypatch
):
    monkeypatch.setattr(rate_limit, "STARTS", RateLimitItemPerMinute(5))
    server = new_app(database_url=database_url)
    answers = [call(server, "/v1/logins", b"{}", X_Forwarded_For="10.0.0.5") for _ in range(7)]
    assert [answer[0] for answer in answers] == [201] * 5 + [429] * 2
    assert kind(answers[-1])[1] == "too-many" and 0 < int(answers[-1][2]["retry-after"]) <= 60
    assert sql(database_url, "SELECT count(*) FROM device_login") == [(5,)]
    assert call(server, "/v1/logins", b"{}", X_Forwarded_For="10.0.0.6")[0] == 201


def test_a_token_does_what_it_is_for_and_nothing_else(server, url):
    reading = given(url, "ann", ["read"])
    assert call(server, f"{SLUG}", token=reading)[0] == 200
    assert kind(call(server, SLUG, ZEROS, reading)) == (
        403,
        "not-allowed",
        "this token does not permit submit, only read: use another token",
    )


def test_what_others_sent_is_for_staff_only(server, url):
    ann, ben, prof = given(url, "ann"), given(url, "ben"), given(url, "prof")
    run(url, inside(lambda connection: people.enroll(connection, [("prof", "instructor")])))
    path = f"/v1/submissions/{call(server, SLUG, ZEROS, ann)[1]['id']}"
    assert call(server, path, token=ann)[0] == call(server, path, token=prof)[0] == 200
    for part in ("", "/events", "/report.txt", "/figures/omega.png", "/sweep.json"):
        assert kind(call(server, path + part, token=ben)) == (
            403,
            "not-allowed",
            "you don't have permission: another student sent this submission",
        ), part
        assert call(server, path + part)[0] == 401, part
    assert [len(call(server, SLUG, token=t)[1]["submissions"]) for t in (ben, prof)] == [0, 0]


def test_a_name_alone_makes_nobody_staff(server, url):
    path = f"/v1/submissions/{call(server, SLUG, ZEROS, given(url, 'ann'))[1]['id']}"
    assert call(server, path, token=given(url, "local"))[0] == 403


def test_who_has_left_the_course_reads_and_does_not_submit(server, url):
    token = given(url, "ivo")
    sent = call(server, SLUG, ZEROS, token)[1]["id"]
    run(url, inside(lambda connection: people.enroll(connection, [("ivo", "former")])))
    status, told, _ = call(server, SLUG, ZEROS, token)
    assert status == 403 and told["type"].endswith("not-allowed") and "left this course" in told["detail"]
    assert call(server, f"/v1/submissions/{sent}", token=token)[0] == 200
    run(url, inside(lambda connection: people.enroll(connection, [("ivo", "student")])))
    assert call(server, SLUG, ZEROS, token)[0] == 202


def test_a_notebook_is_logged_in_by_a_code_confirmed_in_the_browser(server, url):
    asked = call(server, "/v1/logins", b'{"label": "Python on <b>x</b>"}')[1]
    collect = json.dumps({"device_code": asked["device_code"]}).encode()
    assert call(server, "/v1/logins/token", collect)[0] == 202
    browser, login = Browser(server), asked["verification_uri_complete"].removeprefix(server.url)
    status, page = browser.open(login)
    assert status == 200 and asked["user_code"] in page and "Python on &lt;b&gt;x&lt;/b&gt;" in page
    status, page = browser.send(login, login, token="polhode_wrong")
    assert status == 401 and "Python on &lt;b&gt;x&lt;/b&gt;" in page and "token is not valid" in page
    status, page = browser.send(login, login, token=given(url, "eve"))
    assert status == 200 and "Notebook authorized as eve" in page
    status, told, headers = call(server, "/v1/logins/token", collect)
    assert status == 200 and told["person"] == "eve" and headers["cache-control"] == "no-store"
    assert kind(call(server, "/v1/logins/token", collect))[:2] == (410, "login-over")
    assert call(server, SLUG, ZEROS, told["token"])[0] == 202
    assert call(server, "/v1/me/token", token=told["token"], method="DELETE")[0] == 204
    assert call(server, SLUG, ZEROS, told["token"])[0] == 401


def test_a_login_can_be_refused_and_a_code_works_once(server, url):
    asked = call(server, "/v1/logins", b"{}")[1]
    browser, login = Browser(server), f"/login?code={asked['user_code']}"
    assert "Refused" in browser.send(login, login, token=given(url, "eve"), refuse="yes")[1]
    assert (
        call(server, "/v1/logins/token", json.dumps({"device_code": asked["device_code"]}).encode())[0] == 410
    )
    assert browser.send(login, "/account")[0] == 404


def test_another_site_cannot_confirm_in_a_persons_name(server, url):
    browser = Browser(server).log_in(token=given(url, "eve"))
    asked = call(server, "/v1/logins", b"{}")[1]
    login = f"/login?code={asked['user_code']}"
    assert browser.open(login, x="1")[0] == 403, "without the token of a form"
    assert browser.send(login, login, origin="https://evil.example")[0] == 403
    assert (
        call(server, "/v1/logins/token", json.dumps({"device_code": asked["device_code"]}).encode())[0] == 202
    )
    assert "authorized as eve" in browser.send(login, login)[1]  # its own page needs no token again


def test_revoking_a_person_also_ends_a_login_that_is_confirmed_and_not_collected(server, url):
    asked = call(server, "/v1/logins", b"{}")[1]
    login = f"/login?code={asked['user_code']}"
    Browser(server).send(login, login, token=given(url, "gil"))
    run(url, inside(lambda connection: tokens.revoke(connection, person="gil")))
    assert (
        call(server, "/v1/logins/token", json.dumps({"device_code": asked["device_code"]}).encode())[0] == 410
    )


def test_a_notebooks_own_token_opens_no_browser_and_confirms_nothing(server, url):
    status, page = Browser(server).send("/login", token=given(url, "eve", tokens.NOTEBOOK))
    assert status == 403 and "use the token from your course" in page


def test_a_browser_sees_its_own_after_login_and_nothing_after_logout(server, url):
    call(server, SLUG, ZEROS, given(url, "fay"))
    browser = Browser(server)
    for path in ("/", "/assignments/rigid-body"):
        assert "Token from your course" in browser.open(path)[1]
    browser.log_in(token=given(url, "fay"))
    assert all(
        browser.open(path)[1].count('href="/submissions/') == 1 for path in ("/", "/assignments/rigid-body")
    )
    browser.send("/logout")
    assert "You are logged out" in browser.open("/login?out=1")[1] and browser.open("/account")[0] == 200
    assert browser.at == "/login?next=/account"


def test_a_session_survives_a_clock_that_goes_back_and_ends_when_it_expires(server, url, monkeypatch):
    fast = TimestampSigner.get_timestamp
    with monkeypatch.context() as an_hour_fast:
        an_hour_fast.setattr(TimestampSigner, "get_timestamp", lambda signer: fast(signer) + 3600)
        browser = Browser(server).log_in(token=entered(url, "kim"))
    assert browser.open("/account")[0] == 200 and "kim" in browser.open("/account")[1]
    sql(url, "UPDATE token SET expires_at = now() - interval '1 s' WHERE starts_with(prefix, 'session_')")
    assert "kim" not in browser.open("/account")[1]


def test_a_kernel_in_the_hub_submits_with_the_hubs_own_token(server, url, hub):
    assert call(server, SLUG, ZEROS, hub.token_of("ann"))[0] == 202
    assert call(server, "/v1/me", token=hub.token_of("zoë@uni.example"))[1]["person"] == "zoë@uni.example"
    assert call(server, SLUG, ZEROS, hub.token_of("ann", "access:servers!user"))[0] == 401, "not meant for us"
    assert call(server, SLUG, ZEROS, hub.service_token)[0] == 401, "not a person"
    revoked = hub.token_of("ann", "inherit")
    hub.revoke(revoked)
    assert call(server, SLUG, ZEROS, revoked)[0] == 401
    assert ADVISED in OPERATING.read_text(), "what the owner of a hub is told is what this hub runs with"


@pytest.mark.slow
def test_the_kit_gives_the_hubs_token_to_the_server_the_hub_names_and_to_no_other(
    server, url, hub, kit, tmp_path
):
    def attempts(named):
        environment = hub.kernel("ann") | {
            "PYTHONPATH": str(kit),
            "HOME": str(tmp_path),
            "PATH": os.environ["PATH"],
        }
        connect = f"polhode.connect({server.url!r}, assignment='rigid-body')"
        code = f"import polhode; {connect}; print('sent', len(polhode.submissions()))"
        done = subprocess.run(
            [sys.executable, "-P", "-c", code],
            env=environment | named,
            capture_output=True,
            text=True,
            timeout=60,
            cwd=tmp_path,
        )
        return done.stdout + done.stderr

    call(server, SLUG, ZEROS, hub.token_of("ann"))
    assert attempts({"POLHODE_SERVER": server.url + "/"}).startswith("sent ")
    for named in ({}, {"POLHODE_SERVER": "http://other.example"}):
        assert "You are not logged in at" in attempts(named) and hub.token_of("ann") not in attempts(named)


def test_a_page_of_another_site_cannot_submit_to_a_server_at_home(new_app, database_url):
    server = new_app(database_url=database_url, identity="local")
    assert call(server, SLUG, ZEROS, Origin="https://evil.example")[0] == 403
    assert call(server, SLUG, ZEROS, Sec_Fetch_Site="cross-site")[0] == 403
    assert call(server, SLUG, ZEROS, Origin=server.url)[0] == call(server, SLUG, ZEROS)[0] == 202
    assert call(server, "/v1/me", Host="rebound.example")[0] == 403
    assert call(server, "/v1/me", Host="rebound.example@localhost")[0] == 400
    assert call(server, "/v1/me", Host="localhost:1")[0] == 200
    assert call(server, "/v1/me", token="a-proxys-own")[1] == {
        "person": "local",
        "scopes": ["login", "read", "submit"],
        "local": True,
    }


def test_a_hub_that_is_away_is_no_fault_of_the_token(new_app, database_url):
    server = new_app(database_url=database_url, JUPYTERHUB_API_URL="http://127.0.0.1:9/hub/api")
    status, told, headers = call(server, SLUG, ZEROS, "0123456789abcdef")
    assert (status, told["type"].rpartition(":")[2]) == (503, "busy") and headers["retry-after"]


def test_a_page_of_another_site_may_call_if_it_is_named(server, url):
    asked = {"Origin": "https://lite.example", "Access_Control_Request_Method": "POST"}
    asked |= {"Access_Control_Request_Headers": "authorization,content-type,idempotency-key"}
    with urllib.request.urlopen(
        urllib.request.Request(
            server.url + SLUG, None, {k.replace("_", "-"): v for k, v in asked.items()}, method="OPTIONS"
        )
    ) as answer:
        assert answer.headers["access-control-allow-origin"] == "https://lite.example"
        assert "idempotency-key" in answer.headers["access-control-allow-headers"].lower()
    headers = call(server, SLUG, ZEROS, given(url, "ann"), Origin="https://lite.example")[2]
    assert {"Location", "Retry-After"} <= set(re.split(r",\s*", headers["access-control-expose-headers"]))
    assert "access-control-allow-origin" not in call(server, "/v1/me", Origin="https://evil.example")[2]


def test_roster_and_tokens_by_the_command_line(server, url, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("POLHODE_DATABASE_URL", url)

    def polhode(*arguments):
        return main([*map(str, arguments)]), *capsys.readouterr()

    roster, made = tmp_path / "roster.csv", tmp_path / "tokens.csv"
    roster.write_text("name,role\nGül,student\nProf. Hu,instructor\n")
    assert polhode("roster", roster, "--tokens", made) == (
        0,
        f"login name: name, role: role\nimported 2 people; their tokens are in {made}\n",
        "",
    )
    assert made.stat().st_mode & 0o077 == 0 and polhode("roster", roster, "--tokens", made)[0] == 2
    of = {row["name"]: row["token"] for row in csv.DictReader(made.read_text().splitlines())}
    assert call(server, "/v1/me", token=of["Gül"])[1]["person"] == "Gül"
    assert run(url, lambda database: people.role(database, "Prof. Hu")) == "instructor"
    code, listed, _ = polhode("token", "list", "Gül")
    id = listed.split()[0]
    assert code == 0 and of["Gül"][:12] in listed and of["Gül"] not in listed
    assert (
        polhode("token", "revoke", id)[:2] == (0, "revoked 1 token(s)\n")
        and call(server, "/v1/me", token=of["Gül"])[0] == 401
    )
    again = polhode("token", "give", "Gül", "--scope", "read")[1].strip()
    assert call(server, "/v1/me", token=again)[1]["scopes"] == ["read"]
    for text, why in {
        "name,role\nIda,king\n": "The role “king” is not understood",
        "name,shoe\nIda,student\n": "These columns are not understood and not imported.",
        "name\n\x1b[31m\n": "line 2: a name must have 1 to 200 printable characters",
        "name\n": "nobody would be imported",
    }.items():
        roster.write_text(text)
        assert (
            why in polhode("roster", roster, "--tokens", tmp_path / "b")[2] and not (tmp_path / "b").exists()
        )
    roster.write_text("Name\nProf. Hu\n")
    assert polhode("roster", roster, "--tokens", tmp_path / "b")[0] == 0
    assert run(url, lambda database: people.role(database, "Prof. Hu")) == "instructor", (
        "a list of names demotes nobody"
    )
    assert [r[0] for r in sql(url, "SELECT action FROM audit ORDER BY id")][-4:] == [
        "roster",
        "revoke token",
        "give token",
        "roster",
    ]


@pytest.mark.parametrize(
    ("headers", "allowed"),
    [
        ({}, True),  # no browser
        ({"sec-fetch-site": "same-origin"}, True),
        ({"sec-fetch-site": "cross-site"}, False),
        ({"origin": "http://here.example"}, True),
        ({"origin": "https://lite.example"}, True),
        ({"origin": "https://evil.example"}, False),
        ({"origin": "null", "sec-fetch-site": "same-origin"}, False),
    ],
)
def test_only_a_page_of_this_server_or_of_a_named_site_may_send(headers, allowed):
    sent = [(name.encode(), value.encode()) for name, value in ({"host": "here.example"} | headers).items()]
    scope = {
        "type": "http",
        "scheme": "http",
        "method": "POST",
        "path": "/",
        "query_string": b"",
        "headers": sent,
    }
    with contextlib.nullcontext() if allowed else pytest.raises(Problem):
        asyncio.run(
            same_origin(Request(scope), Settings(origins="https://lite.example"), "http://127.0.0.1:8000")
        )
