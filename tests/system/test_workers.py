"""Workers as real processes: one that dies, freezes or is stopped loses nothing; what it had is begun
elsewhere.

A lease is shorter here than a server's, whose own is tested in tests/service/test_settings.py and
test_machines.py.
"""

import json
import os
import re
import signal
import subprocess
import sys
import time
import urllib.error
import urllib.request
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import psycopg
import pytest

from service.cli.__main__ import main
from tests.support.database import jump, sql
from tests.support.machines import children, command_of, started_with
from tests.support.server import WebApplication
from tests.support.submissions import claim, submitted
from tests.support.waiting import wait_for

TAKEOVER_S = 5.0
QUICK = {"POLHODE_LEASE": "0.6"}
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


def running(database_url, id, but=()):
    """Name and process of the worker that runs this submission now."""
    query = (
        "SELECT worker FROM run JOIN grading a ON a.id = grading_id WHERE a.submission_id = %s AND ended_at"
        " IS NULL"
    )
    names = [name for (name,) in rows(database_url, query, id) if name not in but]
    return (names[0], int(names[0].split("/")[1])) if names else None


@pytest.fixture(scope="module")
def front(new_server, tmp_path_factory, url):
    """A server with two workers."""
    data = tmp_path_factory.mktemp("front") / "data"
    started = new_server(data, POLHODE_DATABASE_URL=url, POLHODE_WORKERS="2", POLHODE_DRAIN="2", **QUICK)
    yield started
    started.stop()


def run_of(url, id, worker, column):
    """A column of that worker's run of a submission, or None before it begins."""
    query = (
        f"SELECT {column} FROM run JOIN grading a ON a.id = grading_id WHERE a.submission_id = %s AND worker"
        " = %s"
    )
    return (rows(url, query, id, worker) or [(None,)])[0][0]


def beaten(url, id, worker):
    """Whether that worker has given a sign of life since it began."""
    return run_of(url, id, worker, "heartbeat_at > started_at + interval '0.1 s'")


@pytest.mark.slow  # that a killed worker's work is begun elsewhere is in the next test too
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGSTOP])
def test_what_a_dead_or_frozen_worker_had_is_begun_elsewhere(front, url, how):
    id = post(front.url, SLOW.format(1))["id"]
    name, pid = wait_for(lambda: running(url, id))
    wait_for(lambda: beaten(url, id, name))
    began = time.monotonic()
    os.kill(pid, how)
    try:
        wait_for(lambda: running(url, id, but=[name]))
        assert time.monotonic() - began < TAKEOVER_S
        document = wait_for(lambda: (d := get(front.url, id))["status"] == "graded" and d)
    finally:
        if how == signal.SIGSTOP:
            os.kill(pid, signal.SIGCONT)
    if how == signal.SIGSTOP:
        wait_for(lambda: run_of(url, id, name, "end_reason") == "superseded")  # late, and nothing changes
        assert get(front.url, id) == document


@pytest.mark.slow  # tests/service/store/queue/test_runs.py: a jump that the workers notice
@pytest.mark.parametrize("hours", [1, -1])
def test_a_clock_that_jumps_while_a_submission_is_graded(front, url, hours):
    """As if it jumped between two looks: what is judged lost by mistake is graded once all the same."""
    ids = [post(front.url, SLOW.format(1.5))["id"] for _ in range(3)]
    wait_for(lambda: running(url, ids[0]) and running(url, ids[1]))
    jump(url, hours)
    for id in ids:
        document = wait_for(
            lambda id=id: (d := get(front.url, id))["status"] in ("graded", "faulted") and d, 60
        )
        assert document["status"] == "graded" and document["report"]["passed"]
    results = (
        "SELECT count(*), count(DISTINCT submission_id) FROM result JOIN grading a ON a.id = grading_id "
    )
    assert rows(url, results + "WHERE submission_id = ANY(%s)", ids) == [(3, 3)]
    wait_for(lambda: rows(url, "SELECT count(*) FROM procrastinate_jobs") == [(0,)])
    ends = (
        "SELECT DISTINCT end_reason FROM run JOIN grading a ON a.id = grading_id WHERE submission_id ="
        " ANY(%s)"
    )
    assert {end for (end,) in rows(url, ends, ids)} <= {"finished", "superseded"}


@pytest.mark.slow  # test_runs.py: three lost runs are a fault
@pytest.mark.parametrize("before", [2, 0], ids=["two lost before", "none lost before"])
def test_a_submission_whose_workers_die_is_a_fault_after_three_and_the_next_one_is_served(
    before, front, url, monkeypatch, capsys
):
    id, seen = post(front.url, SLOW.format(1))["id"], []
    lost = "INSERT INTO run (id, grading_id, worker, started_at, ended_at, phase, end_reason, note) "
    lost += (
        "SELECT gen_random_uuid(), id, 'x/1', now(), now(), 'playing', 'lost', 'x' FROM grading WHERE"
        " submission_id = %s"
    )
    for _ in range(before):
        rows(url, lost, id)
    for _ in range(3 - before):
        name, pid = wait_for(lambda: running(url, id, but=seen))
        seen.append(name)
        os.kill(pid, signal.SIGKILL)
    document = wait_for(lambda: (d := get(front.url, id))["status"] == "faulted" and d)
    assert document["report"] is None and "all 3 runs" in document["system_fault"]
    began = time.monotonic()
    assert post(front.url, SLOW.format(0), Prefer="wait=30")["report"]["passed"]
    assert time.monotonic() - began < TAKEOVER_S
    monkeypatch.setenv("POLHODE_DATABASE_URL", url)
    assert main(["regrade", id]) == 0 and capsys.readouterr().out == "queued for regrading: 1\n"
    assert wait_for(lambda: (d := get(front.url, id))["status"] == "graded" and d)["report"]["passed"]


@pytest.fixture
def crew(database_url):
    """Two workers without a server, which give what they have 3 s when they are stopped; the processes are in
    ``workers``.
    """
    environment = (
        os.environ
        | QUICK
        | {
            "POLHODE_DATABASE_URL": database_url,
            "POLHODE_WORKERS": "2",
            "POLHODE_DRAIN": "3",
        }
    )
    process = subprocess.Popen([sys.executable, "-m", "service.cli", "worker"], env=environment)
    try:
        ready = "SELECT split_part(name, '/', 2)::int FROM worker WHERE isolation IS NOT NULL"
        process.workers = wait_for(
            lambda: len(found := rows(database_url, ready)) == 2 and [pid for (pid,) in found], 60
        )
        yield process
    finally:
        process.kill()
        process.wait()


@pytest.mark.slow  # test_slot.py: what a stopped worker has in hand is given back
def test_a_stopped_worker_finishes_or_gives_back(crew, database_url):
    brief, long = (
        submitted(database_url, person, source=SLOW.format(s), exercises=["2"])[0]
        for person, s in (("ann", 0.3), ("bob", 30))
    )
    names = [wait_for(lambda id=id: running(database_url, id))[0] for id in (brief, long)]
    crew.terminate()
    assert crew.wait(15) == 0
    assert [run_of(database_url, *run, "end_reason") for run in zip((brief, long), names, strict=True)] == [
        "finished",
        "released",
    ]
    results = "SELECT submission_id, score = max_score FROM result JOIN grading a ON a.id = grading_id"
    assert rows(database_url, results) == [(brief, True)]
    jobs = (
        "SELECT submission_id, status::text FROM procrastinate_jobs JOIN grading a ON a.id::text ="
        " args->>'attempt'"
    )
    assert rows(database_url, jobs) == [(long, "todo")], "nothing is lost, and nothing graded twice"


def scheduling_group(pid):
    """The group of a session and its niceness, "" where Linux schedules by process."""
    try:
        return Path(f"/proc/{pid}/autogroup").read_text()
    except OSError:
        return ""


@pytest.mark.slow
def test_workers_end_with_a_crew_that_is_killed_and_the_server_starts_another(front, url):
    """The crew is the parent of the workers that are there."""
    recent = "SELECT split_part(name, '/', 2)::int FROM worker WHERE seen_at > now() - interval '10 s'"
    workers = wait_for(
        lambda: (
            len(found := [pid for (pid,) in rows(url, recent) if b"service.cli" in command_of(pid)]) == 2
            and found
        )
    )
    (crew,) = {int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1]) for pid in workers}
    assert set(children(crew)) == set(workers) and crew != front.process.pid
    lower = os.getpriority(os.PRIO_PROCESS, front.process.pid) + 10
    assert {os.getpriority(os.PRIO_PROCESS, pid) for pid in workers} == {lower}
    files = [file for pid in workers for file in Path(f"/proc/{pid}/task").glob("*/children")]
    guests = [int(guest) for file in files for guest in file.read_text().split()]
    guests += [below for guest in guests for below in children(guest)]  # of a guest in namespaces
    groups = {text for pid in guests if (text := scheduling_group(pid))}
    assert guests and all(group.endswith(f" nice {lower}\n") for group in groups), groups
    os.kill(crew, signal.SIGKILL)
    wait_for(lambda: not any(b"service.cli" in command_of(pid) for pid in workers))
    assert post(front.url, SLOW.format(0), Prefer="wait=60")["report"]["passed"]


@pytest.mark.slow  # the two halves are in make test: a worker gives back, and what is queued is graded
def test_what_a_stopped_worker_gives_back_is_graded_by_another(crew, database_url):
    id, _ = submitted(database_url, source=SLOW.format(4), exercises=["2"])
    worker, _ = wait_for(lambda: running(database_url, id))
    crew.terminate()
    assert crew.wait(15) == 0 and run_of(database_url, id, worker, "end_reason") == "released"
    environment = os.environ | {"POLHODE_DATABASE_URL": database_url, "POLHODE_WORKERS": "1"}
    another = subprocess.Popen([sys.executable, "-m", "service.cli", "worker"], env=environment)
    try:
        assert wait_for(lambda: rows(database_url, "SELECT score = max_score FROM result"), 60) == [(True,)]
    finally:
        another.kill()
        another.wait()


def events(url, id, **headers):
    """The events of a submission, to their end."""
    given = {name.replace("_", "-"): value for name, value in headers.items()}
    request = urllib.request.Request(f"{url}/v1/submissions/{id}/events", headers=given)
    with urllib.request.urlopen(request, timeout=60) as answer:
        assert answer.headers["content-type"].startswith("text/event-stream")
        blocks = answer.read().decode().strip().split("\n\n")
    return [
        dict(line.split(": ", 1) for line in block.split("\n") if not line.startswith(":"))
        for block in blocks
    ]


@pytest.mark.slow
def test_progress_reaches_every_server(front, url):
    with WebApplication(url) as other:
        ids = [post(front.url, SLOW.format(0.4))["id"] for _ in range(4)]
        told = events(other.url, ids[-1])
        kinds = [e["event"] for e in told]
        assert kinds[0] == "queued" and "running" in kinds and kinds[-1] == "graded"
        data = [json.loads(e["data"]) for e in told]
        places = [d["position"] for d in data if d["status"] == "queued"]
        assert places[0] <= 4 and places == sorted(places, reverse=True)
        assert (
            any(d["status"] == "running" and d["scenes"] for d in data)
            and data[-1]["score"] == data[-1]["max_score"] == 5
        )
        again = events(other.url, ids[-1], Last_Event_ID=told[-2]["id"])
        assert [e["event"] for e in again] == ["graded"]
        with pytest.raises(urllib.error.HTTPError) as error:
            events(other.url, "nope")
        with error.value:
            assert error.value.code == 404


def _metrics(server):
    with urllib.request.urlopen(f"{server.url}/metrics", timeout=10) as answer:
        return dict(
            line.rsplit(" ", 1)
            for line in answer.read().decode().split("\n")
            if line and not line.startswith("#")
        )


@pytest.mark.slow
def test_metrics(front, url):
    post(front.url, SLOW.format(0), Prefer="wait=30")
    wait_for(lambda: float(_metrics(front)['polhode_workers{state="ready"}']) >= 2)
    told = _metrics(front)
    graded = rows(url, "SELECT count(*) FROM result WHERE report IS NOT NULL")[0][0]
    assert float(told['polhode_results_total{status="graded"}']) == graded > 0
    assert float(told["polhode_wait_seconds_count"]) >= graded
    assert float(told['polhode_runs{ending="finished"}']) == graded
    assert (
        'polhode_http_requests_total{method="POST",route="/v1/assignments/{slug}/submissions",status="200"}'
        in told
    )
    assert not any(
        "/v1/submissions/" in name and "{id}" not in name for name in told
    )  # templates, not addresses


def test_the_queue_as_a_table(database_url, monkeypatch, capsys):
    waits, (runs, grading) = submitted(database_url, "ann")[0], submitted(database_url, "bob")
    sql(
        database_url,
        "UPDATE procrastinate_jobs SET status = 'doing' WHERE args->>'attempt' = %s",
        str(grading),
    )
    claim(database_url, grading, "here/7")
    monkeypatch.setenv("POLHODE_DATABASE_URL", database_url)
    assert main(["queue"]) == 0
    told = capsys.readouterr().out
    assert (
        "     1 interactive waiting" in told
        and re.search(f"^here/7 .*{runs}", told, re.M)
        and str(waits) not in told
    ), told


@pytest.mark.slow
def test_who_waits_for_a_result_is_told_where_it_will_be_when_the_server_stops(
    new_server, tmp_path, database_url
):
    server = new_server(tmp_path / "data", "/livez", POLHODE_DATABASE_URL=database_url, POLHODE_WORKERS="0")
    with ThreadPoolExecutor(2) as pool:
        waiting = pool.submit(post, server.url, SLOW.format(60), Prefer="wait=50")
        id = wait_for(
            lambda: rows(database_url, "SELECT id::text FROM submission WHERE source LIKE %s", "%sleep(60)%")
        )[0][0]
        following = pool.submit(events, server.url, id)
        time.sleep(0.5)  # so that it does follow: what is asked of a server that has stopped is refused
        server.process.terminate()
        assert waiting.result()["id"] == id and following.result()[0]["event"] in ("queued", "running")
    assert server.process.wait(10) == 0 and "Traceback" not in server.log.read_text()


@pytest.mark.slow  # chaos kills servers too; that workers end with their crew is in make test
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
