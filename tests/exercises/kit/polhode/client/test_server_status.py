"""The line that ``polhode.login`` prints, against a server that answers by a script and against none."""

import pytest

import polhode
from polhode.client import cache, course, server_status
from polhode.client.kit_hash import WHEEL, build
from tests.support.fake_server import Scripted, problem, says

RULES = {
    "due_at": "2026-03-01T12:00:00+00:00",
    "extended": False,
    "over": False,
    "submission_limit": 10,
    "used": 3,
}
KIT = says(304, b"", "application/zip")
READY = says(200, {"status": "ready"})
ME = says(200, {"person": "ann", "local": False})


@pytest.fixture
def server(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(server_status, "PATIENCE_S", 0.1)
    monkeypatch.setattr(course, "_connected", [course.Course()])
    monkeypatch.setenv("TZ", "UTC")
    started = Scripted()
    yield started
    started.stop()


def printed(server, capsys, *answers, assignment="rigid-body"):
    server.script += [KIT] * bool(assignment) + [*answers]
    polhode.connect(server.url, assignment=assignment)
    del server.seen[: bool(assignment)]
    del server.script[: bool(assignment)]
    polhode.login()
    return capsys.readouterr().out.replace(server.url, "SERVER")


def test_it_states_the_server_the_deadline_and_the_submissions(server, capsys):
    assert printed(server, capsys, ME, READY, says(200, RULES), says(200, {"kit_build": build()})) == (
        "Logged in as ann.\nSERVER is ready. Deadline: 2026-03-01 12:00 UTC. Submissions used: 3 of 10.\n"
    )
    assert [request.path for request in server.seen][:3] == [
        "/v1/me",
        "/readyz",
        "/v1/assignments/rigid-body/submissions",
    ]


def test_another_kit_on_the_server_is_said(server, capsys):
    text = printed(server, capsys, ME, READY, says(200, RULES), says(200, {"kit_build": "other"}))
    assert f"--no-deps SERVER/kit/{WHEEL}, then restart the kernel." in text


@pytest.mark.parametrize(
    ("rules", "text"),
    [
        (
            {"extended": True, "over": True},
            "12:00 UTC with your extension (over). Submissions used: 3 of 10.",
        ),
        ({"due_at": None, "submission_limit": None}, "is ready. Deadline: none. Submissions used: 3."),
    ],
)
def test_an_extension_a_deadline_that_is_over_and_none(server, capsys, rules, text):
    assert text in printed(server, capsys, ME, READY, says(200, RULES | rules), says(200, {}))


def test_what_fails_is_said_and_does_not_stop_the_notebook(server, capsys):
    text = printed(server, capsys, ME, says(503, {}), problem(404, "not-found", "no assignment rigid-body"))
    assert "SERVER cannot grade at the moment." in text and "No assignment rigid-body." in text


def test_without_the_server_the_local_checks_remain(server, capsys, monkeypatch):
    monkeypatch.setattr("polhode.client.login.CONTACT_S", 0.1)
    monkeypatch.setattr(cache, "PATIENCE_S", 0.1)
    polhode.connect("http://polhode.invalid", assignment="rigid-body")
    polhode.login()
    text = capsys.readouterr().out
    assert "polhode.invalid" in text and text.endswith("polhode.check works without the server.\n")


def test_without_an_assignment_it_is_about_the_server(server, capsys, monkeypatch):
    monkeypatch.setattr(cache, "slugs", list)
    assert printed(server, capsys, ME, READY, assignment=None) == "Logged in as ann.\nSERVER is ready.\n"
