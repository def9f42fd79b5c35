"""Regrade requests and comments over API v1: who may write them, and what is rejected."""

import json
import uuid

import pytest

from service.store.course import comments
from tests.support.database import entered, run, sql
from tests.support.http_client import call
from tests.support.submissions import hand_in

SOURCE = "import numpy as np\n\ndef euler_eqs(t, w, I):\n    return w\n"
WHY = {"reason": "check 2 compares with another axis"}


@pytest.fixture(scope="module")
def ask(server, url):
    """Ask as somebody: status and JSON."""
    people = {"ann": "student", "ben": "student", "tutor": "assistant", "prof": "instructor"}
    tokens = {name: entered(url, name, role) for name, role in people.items()}

    def asked(who, path, body=None, method=None):
        data = None if body is None else body if isinstance(body, bytes) else json.dumps(body).encode()
        headers = {"Authorization": f"Bearer {tokens[who]}", "Content_Type": "application/json"}
        status, _, content = call(server, path, data, method, **headers)
        return status, json.loads(content) if content else None

    return asked


@pytest.fixture
def submission(url):
    """Ann's graded submission."""
    return run(url, lambda database: hand_in(database, "ann", {"2-energy": "✗"}, source=SOURCE))


def test_a_request_is_made_by_its_student_and_answered_by_the_staff(ask, submission):
    path = f"/v1/submissions/{submission}/regrade-requests"
    assert ask("ann", path) == (200, [])
    status, made = ask("ann", path, WHY)
    assert (
        status == 201
        and made["status"] == "open"
        and made["reason"] == WHY["reason"]
        and made["answer"] is None
    )
    answer = f"/v1/regrade-requests/{made['id']}/answer"
    assert ask("ann", answer, {"status": "accepted", "answer": "yes"})[0] == 403
    assert ask("tutor", answer, {"status": "open", "answer": "hm"})[0] == 422
    listed = ask("tutor", "/v1/assignments/rigid-body/regrade-requests")[1]
    (mine,) = (one for one in listed if one["id"] == made["id"])
    assert (mine["person"], mine["points"], mine["total"]) == ("ann", 0, 1)
    status, done = ask("tutor", answer, {"status": "declined", "answer": "axis 2 is right"})
    assert status == 200 and (done["answered_by"], done["answer"]) == ("tutor", "axis 2 is right")
    assert ask("ann", path)[1] == [done] == ask("ann", f"/v1/submissions/{submission}")[1]["regrade_requests"]
    status, problem = ask("prof", answer, {"status": "accepted", "answer": "yes"})
    assert status == 409 and "tutor has already answered" in problem["detail"]


def test_who_may_not_request_a_regrade(ask, submission, url):
    path = f"/v1/submissions/{submission}/regrade-requests"
    assert ask("ben", path, WHY)[0] == 403 and ask("prof", path, WHY)[0] == 403 and ask("ben", path)[0] == 403
    assert ask("ann", "/v1/assignments/rigid-body/regrade-requests")[0] == 403
    assert ask("ann", path, WHY)[0] == 201
    status, problem = ask("ann", path, WHY)
    assert status == 409 and "wait for its answer" in problem["detail"]
    waiting = run(url, lambda database: hand_in(database, "ann", None))
    assert ask("ann", f"/v1/submissions/{waiting}/regrade-requests", WHY)[0] == 409


def test_comments_stand_beside_existing_lines(ask, submission, url):
    path = f"/v1/submissions/{submission}/comments"
    status, one = ask("tutor", path, {"line": 4, "comment": "which equation is this?"})
    assert status == 201 and (one["cell"], one["line"], one["author"]) == (1, 4, "tutor")
    assert ask("ann", path)[1] == [one] == ask("ann", f"/v1/submissions/{submission}")[1]["comments"]
    for place, pointer in (({"line": 5}, "/line"), ({"cell": 2, "line": 1}, "/cell"), ({"line": 0}, "/line")):
        status, problem = ask("tutor", path, place | {"comment": "c"})
        assert status == 422 and problem["errors"][0]["pointer"] == pointer
    assert ask("ann", path, {"line": 1, "comment": "mine"})[0] == 403 and ask("ben", path)[0] == 403
    assert ask("ann", f"{path}/{one['id']}", method="DELETE")[0] == 403
    assert ask("prof", f"{path}/{one['id']}", method="DELETE") == (204, None)
    assert ask("prof", f"{path}/{one['id']}", method="DELETE")[0] == 404
    assert "comments" not in ask("ann", f"/v1/submissions/{submission}")[1]
    actions = sql(url, "SELECT actor, action FROM audit WHERE subject = %s ORDER BY id", str(submission))
    assert actions == [("tutor", "comment"), ("prof", "comment deleted")]


def test_a_student_answers_where_the_staff_commented(ask, submission):
    path = f"/v1/submissions/{submission}/comments"
    assert ask("ann", path, {"line": 4, "comment": "mine"})[0] == 403
    assert ask("tutor", path, {"line": 4, "comment": "which equation?"})[0] == 201
    assert ask("ben", path, {"line": 4, "comment": "not mine"})[0] == 403
    status, answer = ask("ann", path, {"line": 4, "comment": "Euler's"})
    assert status == 201 and answer["author"] == "ann"
    assert ask("ann", path, {"line": 3, "comment": "elsewhere"})[0] == 403
    assert ask("ann", f"{path}/{answer['id']}", method="DELETE")[0] == 403


def test_a_submission_has_a_greatest_number_of_comments(ask, submission, monkeypatch):
    monkeypatch.setattr(comments, "MOST", 2)
    path = f"/v1/submissions/{submission}/comments"
    assert [ask("tutor", path, {"line": 4, "comment": "c"})[0] for _ in range(3)] == [201, 201, 422]


def test_lines_of_a_notebook_are_counted_in_their_cell(ask, url):
    cells = [{"cell_type": "code", "source": text} for text in ("x = 1", "y = 2\nz = 3\n")]
    source = json.dumps({"cells": cells, "nbformat": 4, "nbformat_minor": 5, "metadata": {}})
    sent = run(
        url, lambda database: hand_in(database, "ann", {"2-energy": "✓"}, source=source, filename="a.ipynb")
    )
    path = f"/v1/submissions/{sent}/comments"
    assert ask("prof", path, {"cell": 2, "line": 2, "comment": "c"})[0] == 201
    assert ask("prof", path, {"cell": 1, "line": 2, "comment": "c"})[0] == 422


@pytest.mark.parametrize(
    "body",
    [
        {},
        {"reason": " "},
        {"reason": "a\0b"},
        {"reason": 1},
        {"reason": "x" * 2001},
        WHY | {"points": 5},
        b'{"reason": "\\ud800"}',
    ],
)
def test_a_malformed_request_is_rejected(ask, submission, body):
    assert ask("ann", f"/v1/submissions/{submission}/regrade-requests", body)[0] == 422
    assert ask("ann", f"/v1/submissions/{submission}/regrade-requests") == (200, [])


def test_the_longest_reason_is_stored_and_a_larger_body_is_not_read(ask, submission):
    path = f"/v1/submissions/{submission}/regrade-requests"
    assert ask("ann", path, b" " * 20_000)[0] == 413
    assert ask("ann", path, {"reason": "\u1f10" * 2000})[0] == 201


def test_ids_that_do_not_exist(ask, submission):
    answer = {"status": "accepted", "answer": "yes"}
    for id in (uuid.uuid4(), "none"):
        assert ask("prof", f"/v1/regrade-requests/{id}/answer", answer)[0] == 404
        assert ask("prof", f"/v1/submissions/{submission}/comments/{id}", method="DELETE")[0] == 404
        assert ask("prof", f"/v1/submissions/{id}/comments", {"line": 1, "comment": "c"})[0] == 404
