"""What the server says of itself: alive, ready, and why nothing can be graded."""

import json

from service.store import workers
from tests.support.database import run
from tests.support.http_client import call, post

REFUSAL = "POLHODE_MIN_ISOLATION is namespaces, but namespaces are not available"


def test_where_no_worker_has_a_sandbox_no_submission_is_taken_and_everything_says_why(new_app, database_url):
    app = new_app(database_url=database_url, identity="local")
    run(database_url, lambda database: workers.register_worker(database, "w1", None, REFUSAL))
    status, _, body = call(app, "/readyz")
    assert (status, json.loads(body)["checks"]) == (503, {"isolation": REFUSAL, "walls": REFUSAL, "database": "ok"})
    status, _, body = post(app, {"source": "x = 1"})
    problem = json.loads(body)
    assert status == 503 and problem["type"] == "urn:polhode:problem:no-walls" and REFUSAL in problem["detail"]
    assert call(app, "/livez")[0] == call(app, "/v1/assignments")[0] == 200
