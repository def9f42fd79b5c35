"""The database away for longer than every pool waits: calls say so, results in hand are kept, and all
recovers by itself.
"""

import json
import time
import urllib.error
import urllib.request

import psycopg
import pytest

from service.store.postgres.backup import check
from service.store.postgres.server import EmbeddedPostgres

RIGHT = "import time\ntime.sleep({})\ndef euler_eqs(t, w, I):\n    return -np.cross(w, I * w) / I\n"
# Seconds it is out, seconds a submission sleeps in each of two children, workers, and settings. Procrastinate
# has been seen to leave jobs "doing" after forty seconds.
SHORT = pytest.param(
    3.0, 0.4, 1, {"POLHODE_LEASE": "0.8", "POLHODE_DATABASE_WAIT": "0.5"}, id="3 s", marks=pytest.mark.slow
)
LONG = pytest.param(40.0, 3.0, 2, {}, id="40 s", marks=pytest.mark.slow)
PATH = "/v1/assignments/rigid-body/submissions"


def call(url, path, document=None, **headers):
    data = None if document is None else json.dumps(document).encode()
    given = {"Content-Type": "application/json"} | {
        name.replace("_", "-"): value for name, value in headers.items()
    }
    try:
        with urllib.request.urlopen(urllib.request.Request(url + path, data, given), timeout=30) as answer:
            return answer.status, answer.headers, json.load(answer)
    except urllib.error.HTTPError as error:
        with error:
            return error.code, error.headers, json.load(error)


def wait_for(found, seconds=60.0):
    until = time.monotonic() + seconds
    while not (answer := found()):
        assert time.monotonic() < until, "not in time"
        time.sleep(0.1)
    return answer


@pytest.mark.parametrize(("out_s", "sleep_s", "workers", "settings"), [SHORT, LONG])
def test_an_outage(out_s, sleep_s, workers, settings, new_server, tmp_path):
    database = EmbeddedPostgres(tmp_path / "database")
    database.start()
    try:
        server = new_server(
            tmp_path / "data", POLHODE_DATABASE_URL=database.url, POLHODE_WORKERS=str(workers), **settings
        )
        body = {"source": RIGHT.format(sleep_s), "exercises": ["2"]}
        ids = [call(server.url, PATH, body)[2]["id"] for _ in range(2 * workers + 1)]
        with psycopg.connect(database.url) as connection:
            wait_for(
                lambda: (
                    connection.execute("SELECT count(*) FROM run WHERE ended_at IS NULL").fetchone()
                    == (workers,)
                )
            )
        database.stop()  # each worker grades one, the others wait
        _out(server.url, body, out_s)
        database.start()
        back = time.monotonic()
        late = wait_for(
            lambda: (a := call(server.url, PATH, body, Idempotency_Key="k"))[0] == 202 and a[2]["id"], 10
        )
        for id in [*ids, late]:
            document = wait_for(
                lambda id=id: (d := call(server.url, f"/v1/submissions/{id}")[2])["status"] == "graded" and d
            )
            assert document["report"]["passed"]
        assert time.monotonic() - back < 60
        _nothing_is_left(database.url, workers)
        assert not any(check(database.url).values())
        server.stop()
    finally:
        database.stop()


def _out(url, body, seconds):
    """Ask again and again while database unavailable: every answer says that, and when to come back."""
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        for target, document in ((PATH, body), ("/readyz", None)):
            status, headers, answer = call(url, target, document, Idempotency_Key="k")
            assert status == 503 and int(headers["retry-after"]) > 0, answer
        assert call(url, PATH, body)[2]["type"] == "urn:polhode:problem:busy"
        time.sleep(min(3.0, seconds / 10))


def _nothing_is_left(url, workers):
    """The first run began soon after the database was back, none failed, and no job stays."""
    with psycopg.connect(url, autocommit=True) as connection:
        began = "SELECT min(extract(epoch FROM started_at - %s)) FROM run WHERE started_at > %s"
        up = connection.execute("SELECT pg_postmaster_start_time()").fetchone()[0]
        assert connection.execute(began, (up, up)).fetchone()[0] < 5
        ends = dict(connection.execute("SELECT end_reason, count(*) FROM run GROUP BY 1").fetchall())
        assert ends.get("failed", 0) == 0, ends  # a lost connection is no failure of a grading
        before = "SELECT count(*) FROM run WHERE started_at < %s AND end_reason = 'finished'"
        assert connection.execute(before, (up,)).fetchone() == (workers,), "what was in hand is kept"
        wait_for(lambda: connection.execute("SELECT count(*) FROM procrastinate_jobs").fetchone() == (0,), 10)
