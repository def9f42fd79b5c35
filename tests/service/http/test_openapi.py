"""The OpenAPI document against real responses: every route is requested, and what it returns is declared."""

import json
import re

import pytest

from polhode.client.kit_hash import WHEEL
from polhode.report.report import Picture
from service.grading.submission import MIB
from service.http.errors import PROBLEM_TYPE, TITLES
from service.store.course import comments, regrade_requests
from service.store.submissions.artefacts import store_artefacts
from tests.support.database import entered, run
from tests.support.http_client import call
from tests.support.submissions import graded, submitted

SLUG, OWN = "/v1/assignments/rigid-body", "/v1/submissions/{id}"
SUBMIT = ("POST", "/v1/assignments/{slug}/submissions", f"{SLUG}/submissions")
REQUESTED, ANSWER = "/v1/assignments/{slug}/regrade-requests", "/v1/regrade-requests/{request}/answer"
COMMENT, ONE_COMMENT = b'{"line": 1, "comment": "c"}', f"{OWN}/comments/{{comment}}"
NO_ANSWER = b'{"line": 2, "comment": "c"}'  # on a line without a comment
STAFF = {"Authorization": "staff"}
SOURCE = b'{"source": "x = 1"}'
ARTEFACTS = ("figures/omega.png", "figures/omega.svg", "sweep.json", "sweep.svg", "animations/spin.png")

# Method, route, request path, status, and what else there is: body, headers. {id} is graded, {open} waits.
GET = [
    ("/livez", "/livez", 200, {}),
    ("/livez", "/livez", 400, {"Host": "[::"}),
    ("/readyz", "/readyz", 503, {}),
    ("/metrics", "/metrics", 200, {}),
    ("/v1/assignments", "/v1/assignments", 200, {}),
    ("/v1/assignments/{slug}", SLUG, 200, {}),
    ("/v1/assignments/{slug}", "/v1/assignments/none", 404, {}),
    ("/v1/assignments/{slug}/notebook.ipynb", f"{SLUG}/notebook.ipynb", 200, {}),
    ("/v1/assignments/{slug}/notebook.ipynb", "/v1/assignments/none/notebook.ipynb", 404, {}),
    ("/v1/assignments/{slug}/submissions", f"{SLUG}/submissions", 200, {}),
    ("/v1/assignments/{slug}/submissions", f"{SLUG}/submissions", 401, {"Authorization": "Bearer polhode_x"}),
    ("/v1/assignments/{slug}/kit", f"{SLUG}/kit", 200, {}),
    ("/v1/assignments/{slug}/kit", "/v1/assignments/none/kit", 404, {}),
    ("/kit/{name}", f"/kit/{WHEEL}", 200, {}),
    ("/kit/{name}", "/kit/none", 404, {}),
    ("/v1/me", "/v1/me", 200, {}),
    ("/v1/me", "/v1/me", 401, {"Authorization": "Bearer none"}),
    (OWN, OWN, 200, {}),
    (OWN, OWN, 401, {"Authorization": ""}),
    (OWN, "/v1/submissions/none", 404, {}),
    (f"{OWN}/report.txt", f"{OWN}/report.txt", 200, {}),
    (f"{OWN}/report.txt", "/v1/submissions/{open}/report.txt", 409, {}),
    (f"{OWN}/report.junit.xml", f"{OWN}/report.junit.xml", 200, {}),
    (f"{OWN}/report.junit.xml", "/v1/submissions/{open}/report.junit.xml", 409, {}),
    (f"{OWN}/regrade-requests", f"{OWN}/regrade-requests", 200, {}),
    (f"{OWN}/comments", f"{OWN}/comments", 200, {}),
    (REQUESTED, f"{SLUG}/regrade-requests", 403, {}),
    (REQUESTED, f"{SLUG}/regrade-requests", 200, STAFF),
    (f"{OWN}/events", f"{OWN}/events", 200, {}),
    (f"{OWN}/events", "/v1/submissions/none/events", 404, {}),
    (f"{OWN}/figures/{{name}}.{{form}}", f"{OWN}/figures/omega.png", 200, {}),
    (f"{OWN}/figures/{{name}}.{{form}}", f"{OWN}/figures/omega.svg", 200, {}),
    (f"{OWN}/figures/{{name}}.{{form}}", f"{OWN}/figures/omega.svg", 304, {"If_None_Match": "*"}),
    (f"{OWN}/figures/{{name}}.{{form}}", f"{OWN}/figures/none.svg", 404, {}),
    (f"{OWN}/figures/{{name}}.{{form}}", f"{OWN}/figures/omega.gif", 422, {}),
    (f"{OWN}/sweep.{{form}}", f"{OWN}/sweep.json", 200, {}),
    (f"{OWN}/sweep.{{form}}", f"{OWN}/sweep.svg", 200, {}),
    (f"{OWN}/sweep.{{form}}", "/v1/submissions/{open}/sweep.svg", 409, {}),
    (f"{OWN}/animations/{{name}}.png", f"{OWN}/animations/spin.png", 200, {}),
    (f"{OWN}/animations/{{name}}.png", f"{OWN}/animations/none.png", 404, {}),
]
OTHER = [
    (*SUBMIT, 202, SOURCE, {}),
    (*SUBMIT, 429, SOURCE, {}),
    (*SUBMIT, 400, b"{", {}),
    (*SUBMIT, 401, SOURCE, {"Authorization": ""}),
    (*SUBMIT, 413, b" " * (MIB + 1), {}),
    (*SUBMIT, 415, SOURCE, {"Content_Type": "text/plain"}),
    (*SUBMIT, 422, b"{}", {}),
    ("POST", "/v1/logins", "/v1/logins", 201, b"{}", {}),
    ("POST", "/v1/logins", "/v1/logins", 422, b"[]", {}),
    ("POST", "/v1/logins", "/v1/logins", 413, b" " * 20_000, {}),
    ("POST", "/v1/logins/token", "/v1/logins/token", 410, b'{"device_code": "none"}', {}),
    ("POST", "/v1/logins/token", "/v1/logins/token", 422, b"{}", {}),
    ("POST", f"{OWN}/regrade-requests", f"{OWN}/regrade-requests", 201, b'{"reason": "r"}', {}),
    ("POST", f"{OWN}/regrade-requests", f"{OWN}/regrade-requests", 409, b'{"reason": "r"}', {}),
    ("POST", f"{OWN}/regrade-requests", f"{OWN}/regrade-requests", 422, b"{}", {}),
    (
        "POST",
        ANSWER,
        "/v1/regrade-requests/{regrade_request}/answer",
        200,
        b'{"status": "declined", "answer": "a"}',
        STAFF,
    ),
    (
        "POST",
        ANSWER,
        "/v1/regrade-requests/{regrade_request}/answer",
        409,
        b'{"status": "declined", "answer": "a"}',
        STAFF,
    ),
    ("POST", f"{OWN}/comments", f"{OWN}/comments", 403, NO_ANSWER, {}),
    ("POST", f"{OWN}/comments", f"{OWN}/comments", 201, COMMENT, STAFF),
    ("DELETE", ONE_COMMENT, f"{OWN}/comments/{{comment}}", 204, None, STAFF),
    ("DELETE", ONE_COMMENT, f"{OWN}/comments/{{comment}}", 404, None, STAFF),
    ("DELETE", "/v1/me/token", "/v1/me/token", 204, None, {}),
    ("DELETE", "/v1/me/token", "/v1/me/token", 401, None, {"Authorization": ""}),
]
REQUESTS = [("GET", *wanted[:3], None, wanted[3]) for wanted in GET] + OTHER


@pytest.fixture(scope="module")
def document(server):
    return json.loads(call(server, "/openapi.json")[2])


@pytest.fixture(scope="module")
def server(new_app, url):
    """A server on which a person has at most two waiting submissions."""
    return new_app(database_url=url, open_submissions=2, upload_mib=1, submission_kib=100)


@pytest.fixture(scope="module")
def ids(url):
    """Ann's graded submission with its pictures and a comment, one that waits, and a regrade request."""
    picture = {
        "figures": [Picture("omega", "2", "ω", "ω(t)")],
        "animations": [Picture("spin", "2", "spin", "a spin")],
    }
    id, (waiting, _) = graded(url, "ann", "+", **picture), submitted(url, "ann")

    async def store(database):
        grading = (await database.rows("SELECT id FROM grading WHERE submission_id = %(id)s", {"id": id}))[
            0
        ].id
        await store_artefacts(database, grading, {name: name.encode() for name in ARTEFACTS})

        requested = await regrade_requests.request(database, other, "ann", "r")
        comment = await comments.write(database, id, "prof", cell=1, line=1, comment="c")
        return {"regrade_request": requested.id, "comment": comment.id}

    other = graded(url, "ann", "+")
    return {"id": id, "open": waiting} | run(url, store)


def test_every_route_returns_what_the_document_declares(server, document, ids, url):
    authorization, staff = f"Bearer {entered(url, 'ann')}", f"Bearer {entered(url, 'prof', 'instructor')}"
    for method, route, path, status, body, headers in REQUESTS:
        path = path.format_map(ids)
        headers = (
            {"Authorization": authorization}
            | ({"Content_Type": "application/json"} if body else {})
            | headers
        )
        headers |= {"Authorization": staff} if headers["Authorization"] == "staff" else {}
        answered, received, content = call(server, path, body, method, **headers)
        assert answered == status, (method, path, content[:300])
        declared = document["paths"][route][method.lower()]["responses"]
        assert str(status) in declared, (method, route, status)
        media = received.get("content-type", "").partition(";")[0]
        assert ([media] if media else []) == [
            m for m in declared[str(status)].get("content", {}) if m == media
        ], (method, path)
        assert bool(media) == bool(declared[str(status)].get("content")), (method, path)
        if media == PROBLEM_TYPE:
            kind = json.loads(content)["type"].removeprefix("urn:polhode:problem:")
            assert f"`{kind}`" in declared[str(status)]["description"], (method, path, kind)
    operations = {
        (method.upper(), route) for route, methods in document["paths"].items() for method in methods
    }
    assert operations == {(method, route) for method, route, *_ in REQUESTS}


def test_every_error_is_a_problem_and_every_reference_leads_somewhere(document):
    for route, methods in document["paths"].items():
        for operation in methods.values():
            for status, response in operation["responses"].items():
                problem = status >= "4" and (route, status) != ("/readyz", "503")
                assert (PROBLEM_TYPE in response.get("content", {})) is problem, (route, status)
            assert {"400", "500"} <= operation["responses"].keys(), route
    for name in re.findall(r"#/components/schemas/(\w+)", json.dumps(document)):
        assert name in document["components"]["schemas"]
    assert len(document["components"]["schemas"]["Problem"]["properties"]["type"]["enum"]) == len(TITLES)


def test_the_document_has_the_body_of_a_submission_as_the_server_reads_it(server, document, url):
    body = document["paths"]["/v1/assignments/{slug}/submissions"]["post"]["requestBody"]
    assert body["required"] and set(body["content"]) == {"application/json", "multipart/form-data"}
    fields = body["content"]["application/json"]["schema"]["properties"]
    examples = {"source": "x = 1", "filename": "mine.py", "exercises": ["2"]}
    assert fields.keys() == examples.keys()
    headers = {"Authorization": f"Bearer {entered(url, 'dora')}", "Content_Type": "application/json"}
    assert call(server, f"{SLUG}/submissions", json.dumps(examples).encode(), **headers)[0] == 202
    assert (
        call(server, f"{SLUG}/submissions", json.dumps(examples | {"other": 1}).encode(), **headers)[0] == 422
    )
