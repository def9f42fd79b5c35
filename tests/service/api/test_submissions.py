"""The HTTP interface against a real server: contract, errors as problems, nothing half-stored,
nothing lost.
"""

import io
import json
import signal
import time
import uuid
from xml.etree import ElementTree

import pytest
from PIL import Image

from service.cli.__main__ import main
from tests.support.http_client import SUBMISSIONS, call, post

ZEROS = "def euler_eqs(t, w, I):\n    return [0.0, 0.0, 0.0]\n"

ISOLATION = "namespaces: bubblewrap, landlock, seccomp, limits"


def form(filename, content, **fields):
    parts = [f'name="{k}"\r\n\r\n{v}'.encode() for k, v in fields.items()]
    parts.append(f'name="file"; filename="{filename}"\r\n\r\n'.encode() + content)
    body = (
        b"".join(b"--bound\r\nContent-Disposition: form-data; " + part + b"\r\n" for part in parts)
        + b"--bound--\r\n"
    )
    return body, "multipart/form-data; boundary=bound"


def stored(server):
    """How many submissions the page lists."""
    return call(server, "/")[2].decode().count('href="/submissions/')


@pytest.fixture(scope="module")
def server(real_server):
    return real_server


@pytest.fixture(scope="module")
def right(server, rigid_body):
    source = (rigid_body.folder / "samples" / "right_all.py").read_text()
    status, _, body = post(server, {"source": source}, Prefer="wait=60")
    assert status == 200
    return json.loads(body)


def test_health(server):
    assert call(server, "/livez")[0] == 200
    assert json.loads(call(server, "/readyz")[2]) == {
        "status": "ready",
        "checks": {"isolation": ISOLATION, "database": "ok"},
    }


def test_assignments_tell_checks_tolerances_and_reasons(server):
    assert "rigid-body" in [a["slug"] for a in json.loads(call(server, "/v1/assignments")[2])]
    document = json.loads(call(server, "/v1/assignments/rigid-body")[2])
    checks = {c["id"]: c for e in document["exercises"] for c in e["checks"]}
    assert checks["2-energy"]["tolerance"] == {"limit": 1e-6, "reason": "the notebook's own tolerance"}
    assert document["exercises"][1]["functions"] == ["euler_eqs"]


def test_report_as_json_and_text(server, right):
    assert (
        right["status"] == "graded"
        and right["report"]["passed"]
        and right["report"]["provenance"]["isolation"] == ISOLATION
    )
    status, headers, body = call(server, f"/v1/submissions/{right['id']}/report.txt")
    assert status == 200 and headers["content-type"].startswith("text/plain")
    lines = [o["line"] for e in right["report"]["exercises"] for o in e["outcomes"]]
    assert [line for line in body.decode().split("\n") if line.startswith("✓")] == lines


def test_report_as_junit_xml(server, right):
    status, headers, body = call(server, f"/v1/submissions/{right['id']}/report.junit.xml")
    assert status == 200 and headers["content-type"].startswith("application/xml")
    suites, root = right["report"]["exercises"], ElementTree.fromstring(body)
    assert [suite.get("name").partition(":")[0] for suite in root] == ["submission.py"] * len(suites)
    assert {case.get("name").partition(":")[0] for case in root.iter("testcase")} == {
        o["id"] for e in suites for o in e["outcomes"]
    }
    assert (root.get("failures"), root.get("errors")) == ("0", "0") and float(root.get("time")) > 0


def test_accepted_at_once_and_graded_soon(server):
    status, headers, body = post(server, {"source": ZEROS, "exercises": ["2"]})
    document = json.loads(body)
    assert (
        status == 202
        and headers["location"] == f"/v1/submissions/{document['id']}"
        and headers["retry-after"]
    )
    assert document["status"] in ("queued", "running")
    deadline = time.monotonic() + 60  # the first one waits until the worker has started
    while document["status"] != "graded" and time.monotonic() < deadline:
        time.sleep(0.1)
        document = json.loads(call(server, headers["location"])[2])
    assert document["report"]["score"] == 2 and document["report"]["max_score"] == 5


def test_files_are_taken_as_py_and_ipynb(server, rigid_body):
    for name in ("right_terms.py", "right_notebook.ipynb"):
        body, kind = form(name, (rigid_body.folder / "samples" / name).read_bytes(), exercises="2")
        status, _, answer = call(server, SUBMISSIONS, body, Content_Type=kind, Prefer="wait=60")
        report = json.loads(answer)["report"]
        assert status == 200 and report["passed"] and [e["number"] for e in report["exercises"]] == ["2"]


def test_figures_are_drawn_on_demand_and_cached(server, right):
    base = f"/v1/submissions/{right['id']}"
    for picture in right["report"]["figures"][:2]:
        status, headers, svg = call(server, f"{base}/figures/{picture['name']}.svg")
        assert (
            status == 200
            and headers["content-type"].startswith("image/svg")
            and picture["alt"] in svg.decode()
        )
    status, headers, png = call(server, f"{base}/figures/omega.png")
    with Image.open(io.BytesIO(png)) as image:
        assert image.format == "PNG"
    assert headers["cache-control"] == "private, no-cache"  # a regrade puts another there
    assert call(server, f"{base}/figures/omega.png", If_None_Match=headers["etag"])[0] == 304
    status, _, sheet = call(server, f"{base}/animations/precession.png")
    with Image.open(io.BytesIO(sheet)) as image:
        assert status == 200 and image.size[0] > 1000
    for missing in ("figures/nope.png", "animations/nope.png", "figures/omega.gif"):
        assert call(server, f"{base}/{missing}")[0] in (404, 422)


@pytest.mark.slow  # the test above draws two of them
def test_every_figure_is_drawn(server, right):
    for picture in right["report"]["figures"]:
        status, headers, svg = call(server, f"/v1/submissions/{right['id']}/figures/{picture['name']}.svg")
        assert (
            status == 200
            and headers["content-type"].startswith("image/svg")
            and picture["alt"] in svg.decode()
        )


def test_pages(server, right):
    status, headers, page = call(server, f"/submissions/{right['id']}")
    assert status == 200 and "default-src 'self'" in headers["content-security-policy"]
    assert "rotational energy conserved" in page.decode() and page.decode().count('class="drawn"') == 8
    assert right["id"] in call(server, "/")[2].decode()


def test_text_from_a_student_is_inert_in_a_page(server):
    source = (
        "print('<script>alert(1)</script>\\u202e')\ndef euler_eqs(t, w, I):\n"
        "    raise ValueError('<img src=x onerror=alert(2)>')"
    )
    document = json.loads(post(server, {"source": source}, Prefer="wait=60")[2])
    page = call(server, f"/submissions/{document['id']}")[2].decode()
    # our own module
    assert (
        "&lt;script&gt;" in page
        and page.count("<script") == 1
        and "<img src=x" not in page
        and "\u202e" not in page
    )


BAD = [
    (b"{", "application/json", 400, "invalid-request"),
    (b"[" * 100_000, "application/json", 400, "invalid-request"),
    (b"[]", "application/json", 422, "invalid-request"),
    (b'{"source": 3}', "application/json", 422, "invalid-request"),
    (b'{"source": "x = 1", "passed": true}', "application/json", 422, "invalid-request"),
    (b'{"source": ""}', "application/json", 422, "bad-submission"),
    (b'{"source": "x = 1\\u0000"}', "application/json", 422, "bad-submission"),
    (json.dumps({"source": "x" * 2_000_000}).encode(), "application/json", 413, "too-large"),
    (json.dumps({"source": "x" * 300_000}).encode(), "application/json", 413, "too-large"),
    (b'{"source": "x = 1", "exercises": ["2", "9"]}', "application/json", 422, "unknown-exercise"),
    (b'{"source": "x = 1", "exercises": []}', "application/json", 422, "invalid-request"),
    (b'{"source": "x = 1", "exercises": "2"}', "application/json", 422, "invalid-request"),
    (b"source=x", "application/x-www-form-urlencoded", 415, "unsupported-media-type"),
    (*form("a.ipynb", b"not a notebook"), 422, "bad-submission"),
    (*form("a.py", b"\x7fELF\x02\x01\x01\x00\xff\xfe"), 422, "bad-submission"),
    (*form("a.exe", b"x = 1"), 422, "bad-submission"),
    (*form("a.py", b"x" * 300_000), 413, "too-large"),
    (b"--bound\r\nnonsense", "multipart/form-data; boundary=bound", 422, "invalid-request"),
    (b"--bound--\r\n", "multipart/form-data; boundary=bound", 422, "invalid-request"),
    (b"x", "multipart/form-data", 400, "invalid-request"),
    (b'{"source": "x = 1", "exercises": ["\\ud800"]}', "application/json", 422, "unknown-exercise"),
    (b'{"source": "x = 1", "\\ud800": 1}', "application/json", 422, "invalid-request"),
]


@pytest.mark.parametrize(("body", "kind", "status", "problem"), BAD, ids=range(len(BAD)))
def test_bad_requests_are_problems_and_leave_nothing(server, body, kind, status, problem):
    before = stored(server)
    got, headers, answer = call(server, SUBMISSIONS, body, Content_Type=kind)
    document = json.loads(answer)
    assert (got, headers["content-type"]) == (status, "application/problem+json")
    assert (
        document["type"] == f"urn:polhode:problem:{problem}"
        and document["status"] == status
        and document["detail"]
    )
    assert stored(server) == before


@pytest.mark.parametrize(
    ("path", "method", "status"),
    [
        ("/v1/assignments/nope", "GET", 404),
        ("/v1/assignments/nope/submissions", "POST", 404),
        ("/v1/submissions/nope", "GET", 404),
        (f"/v1/submissions/{uuid.UUID(int=7)}", "GET", 404),
        (f"/v1/submissions/{uuid.UUID(int=7)}/report.txt", "GET", 404),
        (f"/v1/submissions/{uuid.UUID(int=7)}/report.junit.xml", "GET", 404),
        ("/nope", "GET", 404),
        (SUBMISSIONS, "DELETE", 405),
        (SUBMISSIONS, "POST", 415),
    ],
)
def test_other_errors_have_the_same_shape(server, path, method, status):
    got, headers, answer = call(server, path, method=method)
    assert (got, headers["content-type"], json.loads(answer)["status"]) == (
        status,
        "application/problem+json",
        status,
    )


def test_idempotency_key(server):
    key = uuid.uuid4().hex
    first = json.loads(post(server, {"source": ZEROS, "exercises": ["2"]}, Idempotency_Key=key)[2])
    again = json.loads(
        post(server, {"source": ZEROS, "exercises": ["2"]}, Idempotency_Key=key, Prefer="wait=60")[2]
    )
    assert first["id"] == again["id"] and again["status"] == "graded"
    status, _, answer = post(server, {"source": ZEROS, "exercises": ["3"]}, Idempotency_Key=key)
    assert status == 422 and json.loads(answer)["type"].endswith("key-reused")


def test_a_repetition_is_answered_with_the_last_submission_where_that_is_preferred(server):
    body = {"source": ZEROS + "# repeated\n", "exercises": ["2"]}
    first = json.loads(post(server, body, Prefer="wait=60")[2])
    status, headers, answer = post(server, body, Prefer="wait=60, No-Repeat")
    again = json.loads(answer)
    assert (status, again["id"], again["repeated"], again["report"]["score"]) == (
        200,
        first["id"],
        True,
        first["report"]["score"],
    )
    assert headers["Preference-Applied"] == "no-repeat" and headers["Location"].endswith(first["id"])
    status, _, answer = post(server, body, Prefer="wait=60")
    assert json.loads(answer)["id"] != first["id"] and "repeated" not in json.loads(answer)


def test_many_at_once_with_one_key_are_one_submission(server):
    from concurrent.futures import ThreadPoolExecutor

    key = uuid.uuid4().hex
    with ThreadPoolExecutor(40) as pool:
        answers = list(
            pool.map(
                lambda _: post(server, {"source": ZEROS, "exercises": ["2"]}, Idempotency_Key=key), range(40)
            )
        )
    assert {status for status, _, _ in answers} == {202}
    assert len({json.loads(body)["id"] for _, _, body in answers}) == 1


@pytest.mark.parametrize("name", ["a\0b.py", "\u202egnp.py", "x" * 500 + ".py"])
def test_odd_file_names_are_made_harmless(server, name):
    body, kind = form(name, ZEROS.encode(), exercises="2")
    status, _, answer = call(server, SUBMISSIONS, body, Content_Type=kind, Prefer="wait=60")
    assert status == 200 and json.loads(answer)["status"] == "graded"


def test_numbers_too_large_to_draw_are_a_404_and_not_a_crash(server):
    source = "def euler_eqs(t, w, I):\n    return [0.0, 0.0, 0.0] if t != 7.0 else w\n"
    document = json.loads(post(server, {"source": source, "exercises": ["2"]}, Prefer="wait=60")[2])
    assert call(server, f"/v1/submissions/{document['id']}/figures/omega.svg")[0] == 200
    assert call(server, f"/v1/submissions/{document['id']}/animations/%00.png")[0] == 404


def wait_graded(server, ids):
    deadline = time.monotonic() + 60
    for id in ids:
        while json.loads(call(server, f"/v1/submissions/{id}")[2])["status"] != "graded":
            assert time.monotonic() < deadline
            time.sleep(0.1)


@pytest.mark.slow  # in make test workers are killed (test_workers.py), and databases (test_server.py)
def test_what_was_accepted_survives_a_kill_and_stopping_does_not_wait_for_what_runs(new_server, tmp_path):
    data = tmp_path / "da ta,+"
    first = new_server(data, "/livez", POLHODE_WORKERS="0")
    ids = [json.loads(post(first, {"source": ZEROS, "exercises": ["2"]})[2])["id"] for _ in range(2)]
    first.stop(signal.SIGKILL)
    second = new_server(data, "/livez", POLHODE_WORKERS="1", POLHODE_DRAIN="0.2")
    wait_graded(second, ids)
    running = json.loads(post(second, {"source": "import time\ntime.sleep(60)\n" + ZEROS})[2])["id"]
    while json.loads(call(second, f"/v1/submissions/{running}")[2])["status"] != "running":
        time.sleep(0.05)
    began = time.monotonic()
    assert second.stop() == 0 and time.monotonic() - began < 20
    assert not (data / "postgres" / "postmaster.pid").exists()


@pytest.mark.slow  # the test above does the same without a worker that is killed
def test_what_runs_at_a_kill_is_graded_later(new_server, tmp_path):
    data = tmp_path / "polhode"
    first = new_server(data, POLHODE_WORKERS="1")
    slow = "import time\ntime.sleep(1)\n" + ZEROS
    ids = [json.loads(post(first, {"source": slow, "exercises": ["2"]})[2])["id"] for _ in range(2)]
    first.stop(signal.SIGKILL)
    second = new_server(data, POLHODE_WORKERS="2")
    wait_graded(second, ids)
    assert second.stop() == 0


@pytest.mark.slow  # test_samples grades each of them in process, other tests of this file some over HTTP
def test_every_sample_gets_its_expected_report_over_http(server, rigid_body):
    from concurrent.futures import ThreadPoolExecutor

    from exercises.authoring.assignments.samples import samples

    def grade(sample):
        numbers = {"exercises": ",".join(sample.ask)} if sample.ask else {}
        body, kind = form(sample.file.name, sample.file.read_bytes(), **numbers)
        answer = json.loads(call(server, SUBMISSIONS, body, Content_Type=kind, Prefer="wait=60")[2])
        while answer["status"] in ("queued", "running"):  # on a crowded machine
            time.sleep(0.5)
            answer = json.loads(call(server, f"/v1/submissions/{answer['id']}")[2])
        return answer

    known = samples(rigid_body)
    with ThreadPoolExecutor(3) as pool:
        answers = list(pool.map(grade, known))
    for sample, answer in zip(known, answers, strict=True):
        # on a crowded machine a film may run out of its time: once more, alone
        if sample.unexpected(answer["report"]):
            answer = grade(sample)
        outcomes = [o for e in answer["report"]["exercises"] for o in e["outcomes"]]
        assert not sample.unexpected(answer["report"]), sample.file.name
        assert all(o["cause"] for o in outcomes if o["verdict"] == "unmeasured"), sample.file.name


def test_deadline_number_and_person(new_app, database_url, monkeypatch):
    """Refusals a student meets; who submits is told by the header that was set, and by no other."""
    server = new_app(database_url=database_url, identity="local", person_header="Remote-User")
    monkeypatch.setenv("POLHODE_DATABASE_URL", database_url)

    def told(**headers):
        status, _, answer = post(server, {"source": ZEROS}, **headers)
        document = json.loads(answer)
        return status, document.get("type", "").removeprefix("urn:polhode:problem:") or document["status"]

    def assign(*rules):
        assert main(["assign", "rigid-body", *rules]) == 0

    assert told() == told(Remote_User="") == told(X_Remote_User="ann") == (401, "nobody")
    assert told(Remote_User="ann") == (202, "queued")
    assign("--most", "1")
    assert told(Remote_User="ann") == (403, "none-left") and told(Remote_User="ben") == (202, "queued")
    assign("--due", "2026-01-01T00:00Z")
    assert told(Remote_User="cleo") == (403, "deadline-over")
    seen = [
        call(server, "/", Remote_User=name)[2].decode().count('href="/submissions/')
        for name in ("ann", "ben", "cleo")
    ]
    assert seen == [1, 1, 0] and call(server, "/")[0] == 401


def test_log_lines_are_json_with_ids_and_hold_no_source_and_no_header(server):
    """The real server logs everything."""
    source = "# CANARY-SOURCE\n" + ZEROS + "\nraise ValueError('CANARY-RAISED')"
    headers = {"Authorization": "Bearer CANARY-TOKEN", "Idempotency_Key": f"CANARY-KEY {uuid.uuid4()}"}
    before = len(server.log.read_text())
    status, answered, _ = post(server, {"source": source, "exercises": ["2"]}, Prefer="wait=60", **headers)
    assert status == 200
    assert post(server, {"source": source, "exercises": ["3"]}, **headers)[0] == 422, (
        "another body under that key"
    )
    deadline = time.monotonic() + 30
    while '"graded"' not in (told := server.log.read_text()[before:]) or not told.endswith("\n"):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    assert "CANARY" not in server.log.read_text()
    lines = [json.loads(line) for line in told.splitlines()]
    mine = [line for line in lines if line.get("request") == answered["x-request-id"]]
    assert mine and mine[-1]["route"] == "/v1/assignments/{slug}/submissions" and mine[-1]["status"] == 200
    assert any(line["message"] == "graded" and uuid.UUID(line["grading"]) for line in lines)


@pytest.mark.slow
def test_a_sweep_is_made_when_somebody_asks(server):
    source = "def euler_eqs(t, w, I):\n    return np.cross(I * w, w) / I\n"
    id = json.loads(post(server, {"source": source, "exercises": ["2"]}, Prefer="wait=60")[2])["id"]
    status, headers, content = call(server, f"/v1/submissions/{id}/sweep.json")
    assert status == 200 and len(json.loads(content)["points"]) == 16
    assert call(server, f"/v1/submissions/{id}/sweep.json", If_None_Match=headers["ETag"])[0] == 304
    status, headers, content = call(server, f"/v1/submissions/{id}/sweep.svg")
    assert status == 200 and headers["Content-Type"].startswith("image/svg+xml") and b">RK45<" in content
    id = json.loads(post(server, {"source": "x = 1"}, Prefer="wait=60")[2])["id"]
    status, _, content = call(server, f"/v1/submissions/{id}/sweep.svg")
    assert status == 404 and "not defined" in json.loads(content)["detail"]
