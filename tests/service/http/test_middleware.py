"""What surrounds every request: ids, headers and labels, also where we fail."""

import asyncio
import json

from service.http.metrics import PROCESS
from service.http.middleware import RequestMiddleware


def ask(app, method="GET", path="/x"):
    """Start message and body of the answer."""
    sent = []

    async def receive():
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message):
        sent.append(message)

    scope = {"type": "http", "method": method, "path": path, "headers": [], "query_string": b""}
    asyncio.run(RequestMiddleware(app)(scope, receive, send))
    return sent[0], b"".join(m.get("body", b"") for m in sent[1:])


async def fails(scope, receive, send):
    raise RuntimeError("ours")


async def answers(scope, receive, send):
    assert scope["method"] != "HEAD"
    await send({"type": "http.response.start", "status": 200, "headers": [(b"content-length", b"4")]})
    await send({"type": "http.response.body", "body": b"four"})


def test_a_failure_of_ours_is_a_problem_with_an_id_to_find_it_by(caplog):
    start, body = ask(fails)
    headers = dict(start["headers"])
    assert start["status"] == 500 and json.loads(body)["type"] == "urn:polhode:problem:fault"
    assert len(headers[b"x-request-id"]) == 16 and b"content-security-policy" in headers
    assert any(r.message == "unhandled exception" and r.exc_info for r in caplog.records)


def test_head_is_get_without_its_body():
    start, body = ask(answers, "HEAD")
    assert start["status"] == 200 and body == b"" and ask(answers)[1] == b"four"


def test_a_made_up_method_makes_no_new_series():
    for k in range(50):
        ask(answers, f"MADE{k}")
    methods = {s.labels["method"] for m in PROCESS.collect() for s in m.samples if "method" in s.labels}
    assert "other" in methods and not any(method.startswith("MADE") for method in methods)


async def draws(scope, receive, send):
    await send(
        {"type": "http.response.start", "status": 200, "headers": [(b"content-type", b"image/svg+xml")]}
    )
    await send({"type": "http.response.body", "body": b"<svg/>"})


def test_a_chart_opened_by_itself_may_have_styles_and_nothing_else():
    policies = [dict(ask(app)[0]["headers"])[b"content-security-policy"].decode() for app in (draws, answers)]
    assert "default-src 'none'; style-src 'unsafe-inline'" in policies[0] and policies[0].endswith("sandbox")
    assert "unsafe-inline" not in policies[1]
