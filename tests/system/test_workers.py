"""Workers as real processes: one that dies, freezes or is stopped loses nothing; what it had is begun elsewhere within 5 s."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.request
from concurrent.futures import ThreadPoolExecutor

import psycopg
import pytest

from tests.support.machines import children, command_of, started_with

TAKEOVER_S = 5.0
SLOW = "import time\ntime.sleep({})\ndef euler_eqs(t, w, I):\n    return -np.cross(w, I * w) / I\n"


def post(url, source, **headers):
    body = json.dumps({"source": source, "exercises": ["2"]}).encode()
    given = {name.replace("_", "-"): value for name, value in headers.items()}
    request = urllib.request.Request(
        f"{url}/v1/assignments/rigid-body/submissions", body, {"Content-Type": "application/json"} | given
    )
    with urllib.request.urlopen(request, timeout=90) as answer:
        return json.load(answer)


def get(url, id):
    with urllib.request.urlopen(f"{url}/v1/submissions/{id}", timeout=30) as answer:
        return json.load(answer)


def rows(url, query, *values):
    with psycopg.connect(url, autocommit=True) as connection:
        cursor = connection.execute(query, values)
        return cursor.fetchall() if cursor.description else []


def wait_for(found, seconds=30.0):
    """What ``found()`` gives as soon as it gives something."""
    until = time.monotonic() + seconds
    while not (answer := found()):
        assert time.monotonic() < until, "not in time"
        time.sleep(0.05)
    return answer


def running(database_url, id, but=()):
    """Name and process of the worker that runs this submission now."""
    query = "SELECT worker FROM run JOIN attempt a ON a.id = attempt_id WHERE a.submission_id = %s AND ended_at IS NULL"
    names = [name for (name,) in rows(database_url, query, id) if name not in but]
    return (names[0], int(names[0].split("/")[1])) if names else None


@pytest.fixture(scope="module")
def front(new_server, tmp_path_factory, url):
    """A server with two workers."""
    started = new_server(
        tmp_path_factory.mktemp("front") / "data", POLHODE_DATABASE_URL=url, POLHODE_WORKERS="2", POLHODE_DRAIN="2"
    )
    yield started
    started.stop()


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGSTOP])
def test_what_a_dead_or_frozen_worker_had_is_begun_elsewhere(front, url, how):
    id = post(front.url, SLOW.format(4))["id"]
    name, pid = wait_for(lambda: running(url, id))
    time.sleep(0.7)
    began = time.monotonic()
    os.kill(pid, how)
    wait_for(lambda: running(url, id, but=[name]))
    assert time.monotonic() - began < TAKEOVER_S
    document = wait_for(lambda: (d := get(front.url, id))["status"] == "graded" and d)
    if how == signal.SIGSTOP:
        os.kill(pid, signal.SIGCONT)
        ending = "SELECT ending FROM run JOIN attempt a ON a.id = attempt_id WHERE a.submission_id = %s AND worker = %s"
        assert wait_for(lambda: rows(url, ending, id, name) == [("superseded",)])  # late, and nothing changes
        assert get(front.url, id) == document


def test_a_submission_whose_workers_die_is_a_fault_after_three_and_the_next_one_is_served(front, url):
    id, seen = post(front.url, SLOW.format(3))["id"], []
    for _ in range(3):
        name, pid = wait_for(lambda: running(url, id, but=seen))
        seen.append(name)
        os.kill(pid, signal.SIGKILL)
    document = wait_for(lambda: (d := get(front.url, id))["status"] == "faulted" and d)
    assert document["report"] is None and "begun 3 times" in document["fault"]
    began = time.monotonic()
    assert post(front.url, SLOW.format(0), Prefer="wait=30")["report"]["passed"]
    assert time.monotonic() - began < TAKEOVER_S
    command = [sys.executable, "-m", "service.cli", "regrade", id]
    told = subprocess.run(command, env=os.environ | {"POLHODE_DATABASE_URL": url}, capture_output=True, text=True, check=True)
    assert told.stdout == "queued again: 1\n"
    assert wait_for(lambda: (d := get(front.url, id))["status"] == "graded" and d)["report"]["passed"]


@pytest.mark.parametrize(("seconds", "ending"), [(0.5, "finished"), (5, "released")])
def test_a_stopped_worker_finishes_or_gives_back(url, front, seconds, ending):
    environment = os.environ | {"POLHODE_DATABASE_URL": url, "POLHODE_WORKERS": "1", "POLHODE_DRAIN": "2"}
    crew = subprocess.Popen([sys.executable, "-m", "service.cli", "worker"], env=environment)
    try:
        (mine,) = wait_for(
            lambda: [p for p in children(crew.pid) if rows(url, "SELECT 1 FROM worker WHERE name LIKE %s", f"%/{p}")]
        )
        ids = [post(front.url, SLOW.format(seconds))["id"] for _ in range(3)]
        id = wait_for(lambda: next((i for i in ids if (r := running(url, i)) and r[1] == mine), None))
        crew.terminate()
        assert crew.wait(15) == 0
        query = "SELECT ending FROM run JOIN attempt a ON a.id = attempt_id WHERE a.submission_id = %s AND worker LIKE %s"
        assert rows(url, query, id, f"%/{mine}") == [(ending,)]
        for other in ids:
            wait_for(lambda other=other: get(front.url, other)["status"] == "graded")
    finally:
        crew.kill()
        crew.wait()


def events(url, id, **headers):
    """The events of a submission, to their end."""
    given = {name.replace("_", "-"): value for name, value in headers.items()}
    request = urllib.request.Request(f"{url}/v1/submissions/{id}/events", headers=given)
    with urllib.request.urlopen(request, timeout=60) as answer:
        assert answer.headers["content-type"].startswith("text/event-stream")
        blocks = answer.read().decode().strip().split("\n\n")
    return [dict(line.split(": ", 1) for line in block.split("\n") if not line.startswith(":")) for block in blocks]


def test_progress_reaches_every_server(front, url, new_server, tmp_path):
    other = new_server(tmp_path / "data", POLHODE_DATABASE_URL=url, POLHODE_WORKERS="0")
    ids = [post(front.url, SLOW.format(1.5))["id"] for _ in range(4)]
    told = events(other.url, ids[-1])
    kinds = [e["event"] for e in told]
    assert kinds[0] == "queued" and "running" in kinds and kinds[-1] == "graded"
    data = [json.loads(e["data"]) for e in told]
    places = [d["position"] for d in data if d["status"] == "queued"]
    assert places[0] in (1, 2) and places == sorted(places, reverse=True)
    assert any(d["status"] == "running" and d["scenes"] for d in data) and data[-1]["score"] == data[-1]["max_score"] == 5
    again = events(other.url, ids[-1], Last_Event_ID=told[-2]["id"])
    assert [e["event"] for e in again] == ["graded"]
    with pytest.raises(urllib.error.HTTPError) as error:
        events(other.url, "nope")
    with error.value:
        assert error.value.code == 404
    other.stop()


def test_metrics(front, url):
    post(front.url, SLOW.format(0), Prefer="wait=30")
    with urllib.request.urlopen(f"{front.url}/metrics", timeout=10) as answer:
        told = dict(line.rsplit(" ", 1) for line in answer.read().decode().split("\n") if line and not line.startswith("#"))
    graded = rows(url, "SELECT count(*) FROM result WHERE report IS NOT NULL")[0][0]
    assert float(told['polhode_results_total{status="graded"}']) == graded > 0
    assert float(told["polhode_wait_seconds_count"]) >= graded and float(told['polhode_workers{state="ready"}']) >= 2
    assert float(told['polhode_runs{ending="finished"}']) == graded
    assert 'polhode_http_requests_total{method="POST",route="/v1/assignments/{slug}/submissions",status="200"}' in told
    assert not any("/v1/submissions/" in name and "{id}" not in name for name in told)  # templates, not addresses


def test_the_queue_as_a_table(front, url):
    ids = [post(front.url, SLOW.format(4))["id"] for _ in range(4)]
    command = [sys.executable, "-m", "service.cli", "queue"]
    told = subprocess.run(command, env=os.environ | {"POLHODE_DATABASE_URL": url}, capture_output=True, text=True, check=True)
    assert "interactive waiting" in told.stdout and any(id in told.stdout for id in ids)
    for id in ids:
        wait_for(lambda id=id: get(front.url, id)["status"] == "graded")


def test_who_waits_for_a_result_is_told_where_it_will_be_when_the_server_stops(new_server, tmp_path, url):
    server = new_server(tmp_path / "data", "/livez", POLHODE_DATABASE_URL=url, POLHODE_WORKERS="0")
    stopper = threading.Timer(1.5, server.process.terminate)
    stopper.start()
    with ThreadPoolExecutor(2) as pool:
        waiting = pool.submit(post, server.url, SLOW.format(60), Prefer="wait=50")
        id = wait_for(lambda: rows(url, "SELECT id::text FROM submission WHERE source LIKE %s", "%sleep(60)%"))[0][0]
        following = pool.submit(events, server.url, id)
        assert waiting.result()["id"] == id and following.result()[0]["event"] in ("queued", "running")
    assert server.process.wait(10) == 0 and "Traceback" not in server.log.read_text()
    rows(url, "DELETE FROM procrastinate_jobs")


def test_a_crew_ends_with_a_server_that_is_killed_in_its_first_second(new_server, tmp_path):
    server = new_server(tmp_path / "data", "/livez")
    mine = f"POLHODE_DATA={tmp_path / 'data'}"
    wait_for(lambda: len(_crews(mine)) > 1)
    server.process.kill()
    wait_for(lambda: not _crews(mine), 15)
    database = tmp_path / "data" / "postgres" / "postmaster.pid"
    if database.exists():  # it would wait for the next server
        os.kill(int(database.read_text().split()[0]), signal.SIGQUIT)


def _crews(mine):
    """Servers, crews and workers; the database and guests end in their own time."""
    return [pid for pid in started_with(mine) if b"service.cli" in command_of(pid)]
