"""The demonstration as a newcomer runs it."""

import json
import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.request
from dataclasses import replace
from types import SimpleNamespace

import pytest

from exercises.authoring.assignments.samples import samples
from polhode.judging.outcome import Diagnosis
from polhode.report.dataclass_json import document
from service.cli.server import demo
from service.cli.server.demo_class import add_class
from service.settings import Settings
from tests.support.database import sql
from tests.support.fake_server import Scripted, says
from tests.support.reports import outcome, report

MOST_LINES = 120


@pytest.mark.slow
def test_it_sends_samples_prints_a_table_and_names_those_with_another_report(
    real_server, monkeypatch, capsys
):
    wanted = {"right_terms.py", "wrong_zeros.py"}

    def some(assignment):
        right, wrong = (replace(s, demo=True) for s in samples(assignment) if s.file.name in wanted)
        return [right, replace(wrong, verdicts=right.verdicts)]

    monkeypatch.setattr(demo, "samples", some)
    monkeypatch.setattr(demo, "SLUGS", ["rigid-body"])
    assert demo._grade_all(real_server.url) == ["wrong_zeros.py"]
    head, right_row, wrong_row = capsys.readouterr().out.strip().splitlines()
    assert head.split() == ["rigid-body", "points", "seconds", "first", "cause"]
    assert re.fullmatch(r"✓  right_terms\.py +23 of 23 +\d+\.\d", right_row), right_row
    assert re.fullmatch(
        r"✗  wrong_zeros\.py +\d+ of 23 +\d+\.\d  euler_eqs is zero for every input", wrong_row
    ), wrong_row


def test_a_sample_that_could_not_be_graded_is_graded_once_more(monkeypatch):
    fault = {"id": "1", "status": "faulted", "system_fault": "too busy", "report": None}
    answers = [fault, graded := {"id": "2", "status": "graded", "report": {}}]
    monkeypatch.setattr(demo, "_submit", lambda *sent: answers.pop(0))
    assert demo._graded("", "rigid-body", "a.py", "", None) == (graded, "too busy") and answers == []
    answers[:] = [fault, fault]
    document, _ = demo._graded("", "rigid-body", "a.py", "", None)
    row = demo._row("a.py", document)
    assert row.startswith("!  a.py") and row.endswith("not graded: too busy")


def test_it_waits_for_a_report_as_long_as_the_queue_takes(monkeypatch):
    """A busy machine takes longer than one request may wait."""
    server, sample = Scripted(), SimpleNamespace(ask=("2",))
    waiting = {"id": "7", "status": "queued", "report": None}
    server.script += [
        says(202, waiting),
        says(200, waiting | {"status": "running"}),
        says(200, waiting | {"status": "graded", "report": {}}),
    ]
    try:
        assert demo._submit(server.url, "rigid-body", "a.py", "x = 1", sample)["status"] == "graded"
    finally:
        server.stop()
    assert len(server.seen) == 3


def test_a_long_cause_is_cut_and_the_seconds_are_those_of_the_grading():
    long = Diagnosis("units", "x" * 200, 1.0)
    row = demo._row("a.py", {"report": document(report([outcome("a", "fail", diagnosis=[long])]))})
    assert row == f"✗  {'a.py':40}    0 of 1      1.0  {'x' * 79}…"


@pytest.mark.slow
def test_its_class_is_entered_once(database_url):
    settings = Settings(database_url=database_url)
    count = add_class(settings, demo.SLUGS)
    assert count > 40 and add_class(settings, demo.SLUGS) == 0
    assert sql(database_url, "SELECT count(*) FROM submission") == [(count,)]
    sent = sql(
        database_url,
        "SELECT slug, count(*) > 14 FROM submission JOIN assignment a ON a.id = assignment_id GROUP BY 1",
    )
    assert sorted(sent) == [(slug, True) for slug in sorted(demo.SLUGS)]


@pytest.mark.slow
def test_it_waits_for_a_server_too_busy_to_answer_in_time(monkeypatch, capsys):
    """The first two questions stay without an answer until they are given up."""
    monkeypatch.setattr(demo, "ANSWER_S", 0.1)
    server, answered = Scripted(), threading.Event()
    server.script += [
        lambda handler: answered.wait(10),
        lambda handler: answered.wait(10),
        says(200, {"checks": {"database": "ok"}}),
    ]
    process = subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE)
    try:
        assert demo._wait_ready(process, server.url)
    finally:
        answered.set()
        server.stop()
        process.communicate()
    assert capsys.readouterr().out.endswith(" ..ready: {'database': 'ok'}\n")


@pytest.mark.parametrize("port", [0, 99999])
def test_a_port_that_cannot_be_used_is_named_before_anything_starts(port, monkeypatch, capsys):
    """Another server that listens there would receive the samples."""
    monkeypatch.setattr(subprocess, "Popen", None)
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = port or taken.getsockname()[1]
        monkeypatch.setattr(sys, "argv", ["demo", "--port", str(port)])
        assert demo.main() == 2 and f"polhode: port {port} cannot be used" in capsys.readouterr().err


@pytest.mark.slow
def test_demo_ends_with_the_address_of_a_running_page_and_stops_when_told(tmp_path):
    environment = os.environ | {"POLHODE_DATA": str(tmp_path / "demo"), "PYTHONUNBUFFERED": "1"}
    process = subprocess.Popen(
        [sys.executable, "-m", "service.cli.server.demo"], env=environment, stdout=subprocess.PIPE, text=True
    )
    try:
        told = ""
        while "Press Ctrl-C" not in told:
            line = process.stdout.readline()
            assert line, told[-2000:]
            told += line
        assert "every sample got its expected report" in told
        assert len(told.splitlines()) < MOST_LINES and "Traceback" not in told
        assert told.count("Fix this first:") == 1 and "Job was not found" not in told
        address = re.search(r"open (http://127\.0\.0\.1:\d+/)", told)[1]
        assert re.search(
            rb"\d\d of 40 students submitted", urllib.request.urlopen(address, timeout=10).read()
        )
        with urllib.request.urlopen(
            f"{address}assignments/rigid-body/class/students?by=check", timeout=10
        ) as answer:
            assert b'<td class="pass">' in answer.read(), "what was graded so far is shown"
        given = re.findall(r"Log in as the (instructor|student) ?(.*):\n  (\S+)/login#token=(\S+)", told)
        assert [role for role, *_ in given] == ["instructor", "student"]
        for role, name, _, token in given:
            request = urllib.request.Request(f"{address}v1/me", headers={"Authorization": f"Bearer {token}"})
            with urllib.request.urlopen(request, timeout=10) as answer:
                person = json.load(answer)["person"]
            assert person == "instructor" if role == "instructor" else person.startswith("student-") and name
        process.send_signal(signal.SIGINT)
        process.stdout.close()
        assert process.wait(30) == 0
        time.sleep(0.2)
        assert not (tmp_path / "demo" / "postgres" / "postmaster.pid").exists()
    finally:
        process.terminate()  # it stops its server, however the test went
        process.wait(60)
        process.stdout.close()
