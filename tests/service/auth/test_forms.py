"""Forms, of a real server: who may send them, whatever they are encoded in, and sizes at which a course still
gets its answer.
"""

import csv
import http.client
import io
import re
import uuid

import psycopg
import pytest
from fastapi import Request
from psycopg import sql as part

from service.auth import forms
from service.auth.cookies import Cookies
from service.auth.identity import Person
from service.store.people import people, tokens
from tests.support.database import entered, new_database, run, sql

RULES, CLASS = "/assignments/rigid-body/rules", "/assignments/rigid-body/class"


@pytest.fixture(scope="module")
def boss(server, url):
    """An instructor's token."""
    return entered(url, "boss", "instructor")


def ask(server, token, path, body=None, charset="utf-8"):
    """Status, headers and text of the answer; ``body`` is sent as a form of several parts."""
    headers = {"Accept": "text/html", "Authorization": f"Bearer {token}"}
    headers |= (
        {"Content-Type": f"multipart/form-data; boundary=x; charset={charset}"} if body is not None else {}
    )
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=60)
    try:
        connection.request("GET" if body is None else "POST", path, body, headers)
        answer = connection.getresponse()
        return answer.status, answer.headers, answer.read().decode()
    finally:
        connection.close()


def form(server, token, fields, file=None):
    """The body of a form with the token of a page; values are bytes, ``file`` is name and content of a
    roster.
    """
    found = re.search(r'name="csrf" value="(\w+)"', ask(server, token, "/people")[2])
    parts = [
        (b'"' + name.encode() + b'"', value) for name, value in ({"csrf": found[1].encode()} | fields).items()
    ]
    parts += [(b'"roster"; filename="' + file[0] + b'"', file[1])] if file else []
    return (
        b"".join(b"--x\r\nContent-Disposition: form-data; name=%s\r\n\r\n%s\r\n" % one for one in parts)
        + b"--x--\r\n"
    )


def test_the_token_of_a_form_is_of_one_session_person_or_visit():
    def token(cookie=b"", person=None):
        asked = Request({"type": "http", "headers": [(b"cookie", cookie)]})
        return forms.csrf_token(person, Cookies(asked, b"of this course", None, secure=False))

    sessions = [Person("ann", frozenset(tokens.BROWSER), session=uuid.UUID(int=k)) for k in range(2)]
    people = [
        {"person": person} for person in (*sessions, Person("ann", frozenset()), Person("ben", frozenset()))
    ]
    visits = [{"cookie": b"polhode_visit=" + letter * 43} for letter in (b"a", b"b")]
    assert len({token(**one) for one in [*people, *visits]}) == 6 and all(
        token(**one) == token(**one) for one in people
    )
    ann_as_ben = Person("ben", frozenset(), viewer="ann")
    assert token(person=ann_as_ben) == token(person=Person("ann", frozenset())), "and not that of ben"


@pytest.mark.parametrize("scopes", [("read",), tokens.NOTEBOOK])
def test_a_token_that_may_only_read_or_submit_changes_nothing(server, url, boss, scopes):
    async def given(database):
        async with database.begin() as connection:
            return await tokens.create(connection, "boss", label="a script", scopes=scopes, seconds=1000.0)

    token = run(url, given)
    assert ask(server, token, "/people")[0] == 200
    for path in ("/people", RULES, "/assignments/rigid-body/regrades"):
        status, _, page = ask(
            server,
            token,
            path,
            form(server, token, {"tokens": b"1", "which": b"all"}, (b"a.csv", b"name\nboss\n")),
        )
        assert status == 403 and "does not permit login" in page, path
    assert sql(url, "SELECT count(*) FROM token WHERE label = 'issued with the roster'") == [(0,)]


@pytest.mark.parametrize("name", [b"a\x00b.csv", b"\xff\xfe.csv", "é\u202e.csv".encode()])
def test_a_file_may_have_any_name(server, url, boss, name):
    assert ask(server, boss, "/people", form(server, boss, {}, (name, b"name\nann\n")))[0] == 303
    told = sql(url, "SELECT subject FROM audit WHERE action = 'roster' ORDER BY id DESC LIMIT 1")[0][0]
    assert told.endswith(".csv") and told.isprintable()


@pytest.mark.parametrize("charset", ["unicode_escape", "raw_unicode_escape", "utf-7"])
def test_a_form_may_name_an_encoding_that_gives_half_characters(server, boss, charset):
    half = b"+2AA-" if charset == "utf-7" else rb"\ud800"
    body = form(server, boss, {"name": half, "due": b"2030-01-01", "reason": half})
    assert ask(server, boss, "/assignments/rigid-body/extensions", body, charset)[0] == 422
    assert ask(server, boss, "/login", form(server, boss, {"csrf": half}), charset)[0] == 403


def test_too_large_a_form_is_told_as_one(server, boss):
    status, _, page = ask(server, boss, "/people", form(server, boss, {}, (b"a.csv", b"x" * forms.MOST_FORM)))
    assert status == 413 and f"the form is larger than {forms.MOST_FORM} bytes" in page


@pytest.mark.slow
def test_the_largest_course_is_entered_at_once(new_app, database_url):
    """One by one, ten thousand with tokens took longer than a transaction may: 503."""
    server, boss = new_app(database_url=database_url), entered(database_url, "boss", "instructor")
    lines = "".join(f"p{k:04},student,Person {k},p{k}@uni.example,{k}\n" for k in range(10_000))
    roster = (b"r.csv", f"name,role,full_name,email,student_id\n{lines}=1+2,,,,\n".encode())
    assert ask(server, boss, "/people", form(server, boss, {}, roster))[0] == 422  # one too many
    roster = (b"r.csv", roster[1].replace(lines.splitlines()[0].encode() + b"\n", b""))
    status, _, told = ask(server, boss, "/people", form(server, boss, {"tokens": b"1"}, roster))
    assert status == 200, told
    given = dict(csv.reader(io.StringIO(told)))
    assert len(given) == 10_001 and given["name"] == "token" and "'=1+2" in given and "=1+2" not in given
    known = run(database_url, lambda database: tokens.find(database, given["p9999"]))
    assert known.person == "p9999" and known.over is None and known.scopes == set(tokens.SCOPES)
    assert sql(database_url, "SELECT full_name, email, student_id FROM person WHERE name = 'p9999'") == [
        ("Person 9999", "p9999@uni.example", "9999")
    ]


def test_what_a_roster_leaves_out_stays(database_url):
    async def enter(database):
        async with database.begin() as connection:
            await people.enroll(connection, [("ann", "assistant", "Ann", None, "7"), ("ben",)])
            await people.enroll(connection, [("ann", None, None, "a@b.example"), ("ben", "former", "")])
            await people.enroll(connection, [])

    run(database_url, enter)
    rows = sql(
        database_url,
        "SELECT name, role, full_name, email, student_id FROM person JOIN member ON person_id = person.id",
    )
    assert sorted(row for row in rows if row[0] != "local") == [
        ("ann", "assistant", "Ann", "a@b.example", "7"),
        ("ben", "former", "", "", ""),
    ]


@pytest.mark.parametrize(
    "field",
    [
        {"due": b"0001-01-01T00:00+14:00"},
        {"due": b"9999-12-31T23:59-12:00"},
        {"due": b"soon"},
        {"most": b"0"},
        {"grace": b"nan"},
    ],
)
def test_rules_beyond_the_calendar_are_refused_and_the_pages_stay(server, url, boss, field):
    """No driver reads back the year 0 or 10000: every page with that deadline would be gone."""
    status, _, page = ask(server, boss, RULES, form(server, boss, field))
    assert status == 422 and "expected a " in page
    assert [ask(server, boss, path)[0] for path in ("/", CLASS, "/grades.csv")] == [200, 200, 200]
    assert sql(url, "SELECT due_at, submission_limit FROM assignment WHERE slug = 'rigid-body'") == [
        (None, None)
    ]


def test_a_browser_is_told_everything_as_a_page(server, boss):
    for path, status in ((f"{CLASS}/students?sort=x", 422), ("/nothing", 404), ("/queue/x/cancel", 405)):
        got, headers, page = ask(server, boss, path)
        assert (got, headers.get_content_type()) == (status, "text/html") and 'role="alert"' in page, path
    assert ask(server, boss, "/v1/nothing")[1].get_content_type() == "application/problem+json"


def test_a_browser_is_told_of_an_outage_as_a_page(new_app, postgres):
    url = new_database(postgres.url, "polhode")
    token, server = entered(url, "boss", "instructor"), new_app(database_url=url)
    name = part.Identifier(url.partition("?")[0].rpartition("/")[2])
    with psycopg.connect(postgres.url.replace("/polhode?", "/postgres?"), autocommit=True) as connection:
        connection.execute(part.SQL("ALTER DATABASE {} ALLOW_CONNECTIONS false").format(name))
        connection.execute(
            "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = %s",
            [name.as_string()[1:-1]],
        )
    paths = (
        "/",
        "/people",
        CLASS,
        "/queue",
        "/account",
        "/audit",
        "/grades.csv",
        "/assignments/rigid-body/regrades",
    )
    for path in paths:
        status, headers, page = ask(server, token, path)
        assert (status, headers.get_content_type(), headers["retry-after"]) == (503, "text/html", "5"), path
        assert "the database does not respond" in page
