"""The live queue with a real worker: an endless loop is seen, cancelled, and its worker grades the next one
at once.
"""

import itertools
import json
import os
import re
import subprocess
import sys
import time
import urllib.request

import pytest

from service.http.live_updates import EVERY_S
from service.pages import queue
from service.store.queue import workers
from tests.support.app import App
from tests.support.database import run, sql
from tests.support.visitor import Visitor, enter
from tests.support.waiting import wait_for

GOOD = "def euler_eqs(t, w, I):\n    return -np.cross(w, I * w) / I\n"
# It answers the questions one by one and goes round for ever in the first motion, whose budget is 12 s.
LOOP = (
    GOOD.replace(":\n", ":\n    calls.append(t)\n    while len(calls) > 200:\n        pass\n")
    + "calls = []\n"
)
LOADING = "while True:\n    pass\n" + GOOD


@pytest.fixture(scope="module")
def server(url):
    """An application that takes what is a second in one scene for an endless loop."""
    enter(url, prof="instructor", tutor="assistant", ann="student", ben="student")
    assert queue.LONG_S == 5.0
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(queue, "LONG_S", 1.0)
        started = App(database_url=url)
        yield started
        started.stop()


@pytest.fixture(scope="module")
def worker(url):
    """A worker as its own process."""
    command = [sys.executable, "-m", "service.cli", "worker", "--with-parent", str(os.getpid())]
    environment = os.environ | {"POLHODE_DATABASE_URL": url, "POLHODE_WORKERS": "1"}
    with subprocess.Popen(command, env=environment, stdin=subprocess.DEVNULL) as started:
        try:
            wait_for(lambda: sql(url, "SELECT 1 FROM worker WHERE isolation IS NOT NULL"), 240)
            yield
        finally:  # also where it was not ready in time: the end of the block waits for the process
            started.terminate()


@pytest.fixture(scope="module")
def people(server, url):
    return {name: Visitor(server, url, name) for name in ("prof", "tutor", "ann", "ben")}


def post(server, person, source):
    """Submit as that person; the id."""
    body = json.dumps({"source": source, "exercises": ["2"]}).encode()
    headers = {"Content-Type": "application/json", "Authorization": f"Bearer {person.token}"}
    with urllib.request.urlopen(
        urllib.request.Request(f"{server.url}/v1/assignments/rigid-body/submissions", body, headers),
        timeout=30,
    ) as answer:
        return json.load(answer)["id"]


def grading_of(url, id):
    return sql(url, "SELECT id FROM grading WHERE submission_id = %s ORDER BY number DESC LIMIT 1", id)[0][0]


def runs(url, id):
    query = (
        "SELECT 1 FROM run JOIN grading a ON a.id = grading_id WHERE submission_id = %s AND ended_at IS NULL"
        " AND phase = 'playing'"
    )
    return sql(url, query, id)


@pytest.mark.slow  # test_cancelling.py: what runs is cancelled; test_stopping.py: its guest is free at once
def test_an_endless_loop_is_seen_cancelled_and_its_worker_is_free(server, url, people, worker):
    before = sql(url, "SELECT name, zygote_restarts FROM worker")
    loop = post(server, people["ann"], LOOP)
    wait_for(lambda: runs(url, loop))
    good = post(server, people["ben"], GOOD)
    following = people["tutor"].follow("/queue/events")
    page = wait_for(lambda: (p := people["tutor"].open("/queue")[1]).count("possibly an endless loop") and p)
    assert re.search(r"⏱ \d+ s in one scene", page)
    assert (
        f"/submissions/{loop}" in page
        and f"/submissions/{good}" in page
        and "Waiting: 1" in page
        and "Running: 1" in page
    )
    assert 'data-live="/queue/events"' in page and "<noscript>" in page and before[0][0] in page
    began = time.monotonic()
    assert people["tutor"].send(f"/queue/{grading_of(url, loop)}/cancel", "/queue") == (303, "/queue")
    # at once: no answer older than what was done
    assert f"/submissions/{good}" in people["tutor"].open("/queue")[1]
    wait_for(
        lambda: sql(
            url, "SELECT 1 FROM run JOIN grading a ON a.id = grading_id WHERE submission_id = %s", good
        )
    )
    taken = time.monotonic() - began
    assert taken < 5.0, f"the worker was free after {taken:.1f} s"
    wait_for(lambda: people["ben"].json(f"/v1/submissions/{good}")["status"] == "graded", 10)
    told = people["ann"].json(f"/v1/submissions/{loop}")
    assert (told["status"], told["system_fault"], told["cancelled_by"], told["report"]) == (
        "faulted",
        "cancelled by tutor",
        "tutor",
        None,
    )
    assert "Cancelled by tutor. It does not count" in people["ann"].open(f"/submissions/{loop}")[1]
    assert sql(url, "SELECT name, zygote_restarts FROM worker") == before, (
        "the same worker with the same warm guest"
    )
    scene_ends = "SELECT end_reason FROM run JOIN grading a ON a.id = grading_id WHERE submission_id = %s"
    assert sql(url, scene_ends, loop) == [("cancelled",)] and sql(url, scene_ends, good) == [("finished",)]
    sql(url, "UPDATE grading SET requested_at = requested_at - interval '1 minute'")
    assert run(url, workers.recover) == run(url, workers.sweep) == []
    assert sql(url, "SELECT count(*) FROM grading WHERE submission_id = %s", loop) == [(1,)]
    wait_for(lambda: len(following.events) > 2)
    following.close()
    times, ids = zip(*following.events, strict=True)
    assert all(a != b for a, b in itertools.pairwise(ids))
    assert times[-1] - times[0] > 0.5 * (len(times) - 1), "at most one a second, however late they arrive"
    time.sleep(EVERY_S)  # the page's data is at most so old, so it may still show the grading that ended
    page = people["prof"].open("/queue")[1]
    assert "cancelled by tutor" in page and "Nothing is being graded" in page
    assert (
        "cancelled a grading of" in people["prof"].open("/audit?subject=ann")[1]
        and "No entries for zoe." in people["prof"].open("/audit?subject=zoe")[1]
    )


def test_a_loop_outside_of_every_function_and_what_waits_can_be_cancelled_and_tried_again(
    server, url, people, worker
):
    loop = post(server, people["ann"], LOADING)
    wait_for(lambda: sql(url, "SELECT 1 FROM run WHERE ended_at IS NULL"))
    waiting = post(server, people["ann"], GOOD)
    assert people["prof"].send(f"/queue/{grading_of(url, waiting)}/cancel", "/queue")[0] == 303
    assert people["prof"].send(f"/queue/{grading_of(url, loop)}/cancel", "/queue")[0] == 303
    assert people["prof"].send(f"/queue/{waiting}/retry", "/queue")[0] == 303
    wait_for(lambda: people["ann"].json(f"/v1/submissions/{waiting}")["status"] == "graded")
    # stopped without a report: else it is graded as timed out, after its budget to load
    assert people["ann"].json(f"/v1/submissions/{loop}")["status"] == "faulted"
    again = people["prof"].send(f"/queue/{grading_of(url, waiting)}/cancel", "/queue")
    assert again == (409, "the grading already has a result and cannot be cancelled: reload the page")
    assert people["prof"].send(f"/queue/{waiting}/retry", "/queue")[0] == 409
    for path in ("/queue/x/cancel", f"/queue/{waiting}/cancel"):
        assert people["prof"].send(path, "/queue")[0] == 404


def test_events_are_sent_once(server, url, people):
    first = people["prof"].follow("/queue/events")
    wait_for(lambda: first.events)
    again = people["prof"].follow("/queue/events", last=first.events[0][1])
    other = people["prof"].follow("/queue/events", last="something else")
    wait_for(lambda: other.events)
    time.sleep(1.2)  # the next look, at which nothing has changed
    assert len(first.events) == 1 and again.events == [] and other.events[0][1] == first.events[0][1]
    for one in (first, again, other):
        one.close()


def test_students_are_kept_out(server, url, people):
    ann = people["ann"]
    for path in ("/queue", "/queue/events", "/audit", "/assignments/rigid-body/regrades"):
        status, page = ann.open(path)
        assert status == 403 and "only course staff" in page, path
    sent = post(server, people["ben"], LOOP)  # a worker may have started it already, and cannot finish it
    assert people["tutor"].send(f"/queue/{grading_of(url, sent)}/cancel", "/account")[0] == 303
    for path in (
        f"/queue/{grading_of(url, sent)}/cancel",
        f"/queue/{sent}/retry",
        "/assignments/rigid-body/regrades",
    ):
        assert ann.send(path, "/")[0] == 403, path
    assert people["prof"].send(f"/queue/{sent}/retry", "/audit")[0] == 403, "without the token of a form"


def test_people_have_their_names_beside_their_login_names(server, url, people):
    sql(url, "UPDATE person SET full_name = 'Ben Ængström' WHERE name = 'ben'")
    sent = post(server, people["ben"], LOOP)
    named = re.compile(
        f'<a href="/submissions/{sent}">Ben Ængström</a> <span class="quiet">ben</span>, rigid-body'
    )
    open_page = wait_for(lambda: named.search(page := people["tutor"].open("/queue")[1]) and page)
    assert (
        len(named.findall(open_page)) == 1 and 'aria-label="Cancel the grading of Ben Ængström"' in open_page
    )
    assert people["tutor"].send(f"/queue/{grading_of(url, sent)}/cancel", "/queue")[0] == 303
    failed = people["tutor"].open("/queue")[1].partition('id="faults"')[2]
    assert named.search(failed) and 'aria-label="Retry grading the submission of Ben Ængström"' in failed


@pytest.mark.slow
def test_a_regrade_by_a_real_worker(server, url, people, worker):
    sent = post(server, people["ben"], GOOD)
    wait_for(lambda: people["ben"].json(f"/v1/submissions/{sent}")["status"] == "graded")
    count = sql(url,
        "SELECT count(DISTINCT person_id) FROM submission JOIN grading a ON a.submission_id = submission.id "
                "JOIN result r ON r.grading_id = a.id WHERE report IS NOT NULL")[0][0]  # fmt: skip
    status, where = people["tutor"].send(
        "/assignments/rigid-body/regrades", "/assignments/rigid-body/regrades", which="all"
    )
    assert status == 303 and where.startswith("/regrades/")
    following = people["tutor"].follow(f"{where}/events")
    page = wait_for(lambda: f"{count} of {count} graded" in (p := people["tutor"].open(where)[1]) and p)
    assert (
        f"0 gain, 0 lose, {count} keep their points" in page and "Most frequently changed checks" not in page
    )
    wait_for(lambda: len(following.events) >= 1)
    following.close()
    assert (
        people["tutor"].send(f"{where}/apply", where)[0] == 403
        and "Only an instructor can apply the regrade" in page
    )
    assert people["prof"].send(f"{where}/apply", where) == (303, where)
    dropped = people["prof"].send(f"{where}/drop", "/assignments/rigid-body/regrades")
    assert dropped == (409, "prof has already applied this regrade: reload the page")
