"""Response times of the pages for a class of 500 students with five submissions of forty checks each, on a
real server.

For comparison the main SQL statement of a page is timed alone in the same run, through psycopg.
"""

import json
import statistics
import time
from collections.abc import Callable
from typing import Any

import httpx2
import psycopg

from bench.queue import server
from polhode.report.dataclass_json import document
from service.store.course import gradebook
from service.store.people.people import COURSE
from service.store.postgres.server import running_url
from tests.support.reports import ASSIGNMENT, SLIP, report_of_marks

STUDENTS, EACH, REPEATS = 500, 5, 7
GOAL_MS = 200.0
PEERS = {"/assignments/rigid-body/class": gradebook._STANDINGS, "/": gradebook._OVERVIEW}
PAGES = (
    "/",
    "/people",
    "/queue",
    "/audit",
    "/assignments/rigid-body",
    "/assignments/rigid-body/class",
    "/assignments/rigid-body/class/students",
    "/assignments/rigid-body/class/students?sort=activity",
    "/assignments/rigid-body/class/checks",
    "/assignments/rigid-body/class/settings",
    "/assignments/rigid-body/class/submissions",
    "/assignments/rigid-body/class/submissions?check=2-energy&state=not-pass",
    "/assignments/rigid-body/regrades",
    "/assignments/rigid-body/grades.csv",
    "/assignments/rigid-body/grades.json",
    "/assignments/rigid-body/grades/canvas.csv",
    "/grades.csv",
)


def main() -> None:
    """Fill the database, measure each page and print one line per page."""
    with server(workers=0) as (url, data, _):
        database = running_url(data)
        assert database is not None
        began = time.perf_counter()
        fill(database)
        took = time.perf_counter() - began
        print(
            f"{STUDENTS} students, {STUDENTS * EACH} submissions an assignment,"
            f" {len(ASSIGNMENT.checks())} checks each, inserted in {took:.0f} s; medians of {REPEATS},"
            f" goal {GOAL_MS:g} ms"
        )
        with psycopg.connect(database) as connection, httpx2.Client(base_url=url, timeout=60) as client:
            ids = connection.execute("SELECT id FROM submission LIMIT 2").fetchall()
            for path in (*PAGES, *(f"/submissions/{id}" for (id,) in ids)):
                page(client, connection, path)


def page(client: httpx2.Client, connection: "psycopg.Connection[Any]", path: str) -> None:
    """Measure one page and its main SQL statement."""
    answer = client.get(path, headers={"Remote-User": "prof"})
    columns = [
        f"{median(lambda: client.get(path, headers={'Remote-User': 'prof'})):6.0f} ms",
        f"{int(answer.headers.get('content-length', len(answer.content))) / 1e3:6.0f} kB",
    ]
    if answer.status_code != 200:
        columns.append(f"HTTP {answer.status_code}")
    if statement := PEERS.get(path):
        values = {"slug": ASSIGNMENT.slug, "course": COURSE, "person": None}
        bare = median(lambda: connection.execute(statement, values).fetchall())
        columns.append(f"SQL statement alone {bare:.0f} ms")
    print(f"{path[:76]:76} {', '.join(columns)}", flush=True)


def median(action: Callable[[], Any]) -> float:
    """Return the median time of ``action`` in milliseconds."""
    took = []
    for _ in range(REPEATS):
        began = time.perf_counter()
        action()
        took.append(1e3 * (time.perf_counter() - began))
    return statistics.median(took)


def fill(url: str) -> None:
    """Insert a class with submissions and reports, as a term of real use would leave them."""
    ids = [c.id for c in ASSIGNMENT.checks()]
    with psycopg.connect(url) as connection:
        for number in range(EACH):
            marks = {id: "✓" if k % EACH <= number else ("✗", 0.01, SLIP) for k, id in enumerate(ids)}
            report = report_of_marks(marks)
            values = {
                "n": number,
                "students": STUDENTS,
                "report": json.dumps(document(report)),
                "score": report.score,
                "most": report.max_score,
            }
            connection.execute(_FILL, values)
        connection.execute(_OUTCOMES)
        connection.execute(_STAFF)
        connection.commit()
        connection.autocommit = True
        connection.execute("VACUUM ANALYZE")


_FILL = """
WITH people AS (
    INSERT INTO person (name, full_name) SELECT 'student-' || k, 'Student Number ' || k
      FROM generate_series(1, %(students)s) k
    ON CONFLICT (name) DO UPDATE SET email = excluded.full_name || '@example.org' RETURNING id
), members AS (
    INSERT INTO member SELECT c.id, p.id, 'student' FROM course c, people p ON CONFLICT DO NOTHING
), sent AS (
    INSERT INTO submission (id, assignment_id, person_id, source, sha256, filename, fingerprint, submitted_at)
    SELECT gen_random_uuid(), x.id, p.id, s.source, encode(sha256(convert_to(s.source, 'UTF8')), 'hex'),
        'work.py', '', now() - make_interval(hours => 10 - %(n)s)
    FROM assignment x, people p,
      (SELECT 'def euler_eqs(t, w, I):' || chr(10) || '    return w * ' || %(n)s AS source) s
    RETURNING id
), tried AS (
    INSERT INTO grading (id, submission_id, number, kind, seed, max_runs)
    SELECT gen_random_uuid(), id, 1, 'interactive', 7, 3 FROM sent RETURNING id
)
INSERT INTO result (grading_id, report, score, max_score, version, isolation, grading_s)
SELECT id, CAST(%(report)s AS jsonb), %(score)s, %(most)s, '1', 'namespaces', 1.0 FROM tried
"""

_STAFF = """
WITH prof AS (INSERT INTO person (name) VALUES ('prof') RETURNING id)
INSERT INTO member SELECT c.id, prof.id, 'instructor' FROM course c, prof
"""

_OUTCOMES = """
INSERT INTO outcome (grading_id, check_id, state, counted, margin, codes, causes, points, earned)
SELECT r.grading_id, o->>'id', o->>'verdict', true, (o->>'margin')::float8 * (0.5 + random()),
    ARRAY(SELECT d->>'code' FROM jsonb_array_elements(o->'diagnosis') d),
    ARRAY(SELECT d->>'sentence' FROM jsonb_array_elements(o->'diagnosis') d), (o->>'points')::int,
      (o->>'earned')::int
FROM result r, jsonb_array_elements(r.report->'exercises') e, jsonb_array_elements(e->'outcomes') o
"""

if __name__ == "__main__":
    main()
