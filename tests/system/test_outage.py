"""The database away for longer than every pool waits: calls say so, results in hand are kept, and all recovers by itself."""

import json
import time
import urllib.error
import urllib.request

import psycopg

from service.store.dump import check
from service.store.postgres import EmbeddedPostgres

OUT_S = 40.0  # Procrastinate has been seen to leave jobs "doing" after as long
RIGHT = "import time\ntime.sleep(3)\ndef euler_eqs(t, w, I):\n    return -np.cross(w, I * w) / I\n"


def call(url, path, document=None, **headers):
    data = None if document is None else json.dumps(document).encode()
    given = {"Content-Type": "application/json"} | {name.replace("_", "-"): value for name, value in headers.items()}
    try:
        with urllib.request.urlopen(urllib.request.Request(url + path, data, given), timeout=30) as answer:
            return answer.status, answer.headers, json.load(answer)
    except urllib.error.HTTPError as error:
        return error.code, error.headers, json.load(error)


def test_a_long_outage(new_server, tmp_path):
    database = EmbeddedPostgres(tmp_path / "database")
    database.start()
    server = new_server(tmp_path / "data", POLHODE_DATABASE_URL=database.url, POLHODE_WORKERS="2")
    path, body = "/v1/assignments/rigid-body/submissions", {"source": RIGHT, "exercises": ["2"]}
    ids = [call(server.url, path, body)[2]["id"] for _ in range(5)]
    time.sleep(1)  # two are being graded, three wait
    database.stop()
    out_until = time.monotonic() + OUT_S
    while time.monotonic() < out_until:
        for target in (path, "/readyz"):
            status, headers, answer = call(server.url, target, body if target == path else None, Idempotency_Key="k")
            assert status == 503 and int(headers["retry-after"]) > 0, answer
        assert call(server.url, path, body)[2]["type"] == "urn:polhode:problem:busy"
        time.sleep(3)
    database.start()
    back = time.monotonic()
    late = None
    while late is None:
        status, _, answer = call(server.url, path, body, Idempotency_Key="k")
        late = answer["id"] if status == 202 else None
        assert late or time.monotonic() - back < 10
    for id in [*ids, late]:
        while (told := call(server.url, f"/v1/submissions/{id}")[2])["status"] != "graded":
            assert time.monotonic() - back < 60, told
            time.sleep(0.2)
        assert told["report"]["passed"]
    with psycopg.connect(database.url) as connection:
        began = "SELECT min(extract(epoch FROM started_at - %s)) FROM run WHERE started_at > %s"
        up = connection.execute("SELECT pg_postmaster_start_time()").fetchone()[0]
        assert connection.execute(began, (up, up)).fetchone()[0] < 5
        endings = connection.execute("SELECT ending, count(*) FROM run GROUP BY 1").fetchall()
        assert dict(endings).get("failed", 0) == 0, endings  # a lost connection is no failure of a grading
    time.sleep(2.5)
    with psycopg.connect(database.url) as connection:
        assert connection.execute("SELECT count(*) FROM procrastinate_jobs").fetchone() == (0,)
    assert not any(check(database.url).values())
    server.stop()
    database.stop()
