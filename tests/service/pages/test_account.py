"""The page of one's own account, and the commands that put it right, against a real server."""

import io
import os
import pty
import re
import subprocess
import sys

import pytest

from service.auth import passwords
from service.cli.__main__ import main
from service.store.people import tokens
from tests.support.database import entered, run, sql
from tests.support.http_client import Browser

pytestmark = pytest.mark.usefixtures("cheap_hashes")
PASSWORD, ANOTHER = "correct horse battery", "staple, staple, staple"


def test_it_tells_who_one_is(server, url):
    token = entered(url, "ann", "assistant")
    sql(url, "UPDATE person SET full_name = 'Ann <b>Bo</b>' WHERE name = 'ann'")
    page = (
        Browser(server, User_Agent="Mozilla/5.0 (X11; Linux x86_64; rv:140.0) Firefox/140.0")
        .log_in(token=token)
        .open("/account")[1]
    )
    for told in (
        ">ann</dd>",
        "Ann &lt;b&gt;Bo&lt;/b&gt;",
        ">assistant</dd>",
        "Firefox on Linux, by token <b>(this session)</b>",
        token[:12],
    ):
        assert told in page, told
    assert token not in page and page.count("<caption>") == 2 and "<time datetime=" in page


def test_a_token_logs_in_once_and_then_there_is_a_password(server, url):
    first = Browser(server).log_in(token=entered(url, "ben"))
    other = Browser(server).log_in(token=entered(url, "ben"))
    status, page = first.send("/account/password", password=PASSWORD, again=PASSWORD)
    assert status == 200 and 'role="status"' in page and "Password saved" in page
    assert first.open("/v1/me")[0] == 200 and other.open("/v1/me")[0] == 401, "other browsers are logged out"
    assert Browser(server).send("/login", name="ben", password=PASSWORD)[0] == 200
    assert sql(url, "SELECT password FROM person WHERE name = 'ben'")[0][0].startswith("$argon2id$")
    assert first.send("/account/password", password=ANOTHER, again=ANOTHER)[0] == 401, (
        "now the present one is asked for"
    )
    status, page = first.send("/account/password", present="wrong password", password=ANOTHER, again=ANOTHER)
    assert status == 401 and "the current password is wrong" in page and 'role="alert"' in page
    assert first.send("/account/password", present=PASSWORD, password=ANOTHER, again=ANOTHER)[0] == 200
    assert Browser(server).send("/login", name="ben", password=PASSWORD)[0] == 401
    assert Browser(server).send("/login", name="ben", password=ANOTHER)[0] == 200
    assert [row[0] for row in sql(url, "SELECT action FROM audit WHERE actor = 'ben' ORDER BY id")] == [
        "set password",
        "log in",
    ] * 2


@pytest.mark.parametrize(
    ("password", "again", "why"),
    [
        ("short", "short", "10 to 200"),
        ("x" * 201, "x" * 201, "10 to 200"),
        (PASSWORD, ANOTHER, "passwords do not match"),
        ("Ferdinand Q", "Ferdinand Q", "neither your name"),
        ("aaaaaaaaaaaa", "aaaaaaaaaaaa", "one repeated character"),
    ],
)
def test_what_is_no_password_is_not_set(server, url, password, again, why):
    browser = Browser(server).log_in(token=entered(url, "ferdinand q"))
    status, page = browser.send("/account/password", password=password, again=again)
    assert (
        status == 422
        and why in page
        and sql(url, "SELECT password FROM person WHERE name = 'ferdinand q'") == [(None,)]
    )


def test_a_password_is_the_same_however_its_letters_are_composed(server, url):
    browser = Browser(server).log_in(token=entered(url, "gül"))
    browser.send("/account/password", password="  Gu\u0308neş gibi  ", again="  Gu\u0308neş gibi  ")
    assert Browser(server).send("/login", name="gu\u0308l", password="  Güneş gibi  ")[0] == 200
    assert Browser(server).send("/login", name="gül", password="Güneş gibi")[0] == 401, "spaces count"


def test_one_token_or_session_is_revoked_and_never_somebody_elses(server, url):
    token, theirs = entered(url, "hal"), Browser(server).log_in(token=entered(url, "ida"))
    browser, phone = Browser(server).log_in(token=token), Browser(server).log_in(token=token)
    page = browser.open("/account")[1]
    others = re.findall(r'name="id" value="([^"]+)"', page)
    assert len(others) == 3
    (id,) = sql(
        url,
        "SELECT t.id FROM token t JOIN person p ON p.id = person_id WHERE name = 'hal' AND"
        " starts_with(prefix, 'polhode_')",
    )[0]
    assert theirs.send("/account/revoke", id=str(id))[0] == 404 and phone.open("/v1/me")[0] == 200
    assert (
        browser.send("/account/revoke", id=str(id))[0] == 200
        and Browser(server).send("/login", token=token)[0] == 401
    )
    assert (
        browser.send("/account/revoke", id=str(id))[0] == 404
        and browser.send("/account/revoke", id="x")[0] == 422
    )
    newest = sql(
        url,
        "SELECT t.id FROM token t JOIN person p ON p.id = person_id WHERE name = 'hal' ORDER BY t.created_at"
        " DESC LIMIT 1",
    )
    assert browser.send("/account/revoke", id=str(newest[0][0]))[0] == 200 and phone.open("/v1/me")[0] == 401
    assert sql(url, "SELECT subject FROM audit WHERE actor = 'hal' AND action = 'revoke token'")[0] == (
        str(id),
    )


def test_logging_out_everywhere_ends_every_browser_and_no_token(server, url):
    token = entered(url, "jon")
    browsers = [Browser(server).log_in(token=token) for _ in range(3)]
    stranger = Browser(server).log_in(token=entered(url, "kim"))
    assert "You are logged out" in browsers[0].send("/account/logout-everywhere")[1]
    assert [browser.open("/v1/me")[0] for browser in (*browsers, stranger)] == [401, 401, 401, 200]
    assert Browser(server).log_in(token=token).open("/v1/me")[0] == 200


def test_a_notebooks_token_changes_no_account(server, url):
    async def give(database):
        async with database.begin() as connection:
            return await tokens.create(
                connection, "lea", label="a notebook", scopes=tokens.NOTEBOOK, seconds=1000.0
            )

    notebook = Browser(server, Authorization=f"Bearer {run(url, give)}")
    status, page = notebook.send("/account/password", password=PASSWORD, again=PASSWORD)
    assert status == 403 and "this token does not permit login, only read, submit" in page
    assert sql(url, "SELECT password FROM person WHERE name = 'lea'") == [(None,)]


def test_passwords_by_the_command_line(server, url, monkeypatch, capsys):
    monkeypatch.setenv("POLHODE_DATABASE_URL", url)

    def polhode(*arguments, said):
        monkeypatch.setattr("sys.stdin", io.StringIO(said))
        return main([*arguments]), *capsys.readouterr()

    browser = Browser(server).log_in(token=entered(url, "moe"))
    done = polhode("password", "moe", said=f"{PASSWORD}\n")
    assert done == (0, "the password of moe is set; all browser sessions of moe are logged out\n", "")
    assert (
        browser.open("/v1/me")[0] == 401
        and Browser(server).send("/login", name="moe", password=PASSWORD)[0] == 200
    )
    assert "10 to 200" in polhode("password", "moe", said="short\n")[2]
    assert polhode("password", "nobody", said=PASSWORD) == (
        1, "",
        "polhode: no person named nobody: add people with polhode roster or polhode token give --new\n",
    )  # fmt: skip
    assert sql(url, "SELECT subject FROM audit WHERE action = 'set password' AND subject = 'moe'") == [
        ("moe",)
    ]


@pytest.mark.slow
@pytest.mark.parametrize(("second", "code"), [(ANOTHER, 0), (PASSWORD, 2)])
def test_a_password_typed_at_a_terminal_is_not_shown(url, second, code):
    entered(url, name := f"ned {code}")
    terminal, end = pty.openpty()
    command, environment = (
        [sys.executable, "-m", "service.cli", "password", name],
        os.environ | {"POLHODE_DATABASE_URL": url},
    )
    started = subprocess.Popen(
        command, env=environment, stdin=end, stdout=end, stderr=end, start_new_session=True
    )
    shown = b""
    for prompt, typed in ((f"New password of {name}: ", ANOTHER), ("Repeat new password: ", second)):
        while not shown.endswith(prompt.encode()):
            shown += os.read(terminal, 1000)
        os.write(terminal, typed.encode() + b"\n")
    assert started.wait(60) == code
    shown += os.read(terminal, 1000)
    assert b"ned" in shown and ANOTHER.encode() not in shown
    os.close(terminal)
    os.close(end)
    kept = sql(url, "SELECT password FROM person WHERE name = %s", name)[0][0]
    assert passwords.matches(kept, ANOTHER) if code == 0 else kept is None
