"""Uploads: notebooks with pictures in their outputs, size limits, and large bodies, which block nobody."""

import asyncio
import json
import multiprocessing
import uuid
from concurrent.futures import ThreadPoolExecutor
from hashlib import sha256

import pytest

import polhode
from service.api.parse_submission import MOST_LARGE, LargeBodies, parse_submission
from service.grading.submission import KIB, MIB
from service.settings import Settings
from tests.service.api.test_submissions import form
from tests.support.big_notebook import with_outputs
from tests.support.database import sql
from tests.support.http_client import SUBMISSIONS, call, post


@pytest.fixture(scope="module")
def app(url, new_app):
    """An application with small limits, to which a worker is known."""
    sql(
        url,
        "INSERT INTO worker (name, isolation, seen_at) VALUES ('w', 'namespaces', now() + interval '1 hour')",
    )
    return new_app(database_url=url, identity="local", submission_kib=20, upload_mib=16)


@pytest.fixture(scope="module")
def plain(rigid_body):
    """A right notebook without outputs."""
    return (rigid_body.folder / "samples" / "right_notebook.ipynb").read_bytes()


@pytest.fixture(scope="module")
def full(plain):
    return with_outputs(plain)


def upload(server, content, name="mine.ipynb", **headers):
    body, kind = form(name, content, exercises="2")
    status, _, answer = call(server, SUBMISSIONS, body, Content_Type=kind, **headers)
    return status, json.loads(answer)


def source(url, id):
    """The stored source of a submission."""
    ((stored, digest),) = sql(url, "SELECT source, sha256 FROM submission WHERE id = %s", id)
    assert sha256(stored.encode()).hexdigest() == digest
    return stored


@pytest.mark.parametrize(
    ("name", "status"),
    [("MINE.IPYNB", 202), ("Mine.Py", 202), ("mine.py", 202), ("mine.txt", 422), ("mine", 422)],
)
def test_a_notebook_by_any_name_that_a_submission_may_have(app, url, full, name, status):
    formed, answer = upload(app, full, name)
    posted, _, other = post(app, {"source": full.decode(), "filename": name, "exercises": ["2"]})
    other = json.loads(other)
    assert formed == posted == status
    if status == 202:
        assert len(source(url, answer["id"])) < 20 * KIB and answer["sha256"] == other["sha256"]
    else:
        assert "if it holds Python, give it a name that ends in .py" in answer["detail"] == other["detail"]


def test_a_notebook_with_outputs_is_stored_without_them(app, url, plain, full):
    assert 5 * MIB < len(full) < 16 * MIB
    status, formed = upload(app, full)
    stored = source(url, formed["id"])
    assert status == 202 and len(stored) < 20 * KIB
    cells = json.loads(stored)["cells"]
    assert [c["source"] for c in cells] == [c["source"] for c in json.loads(plain)["cells"]]
    assert formed["sha256"] == sha256(stored.encode()).hexdigest()
    status, _, answer = post(app, {"source": full.decode(), "filename": "mine.ipynb", "exercises": ["2"]})
    assert status == 202 and source(url, json.loads(answer)["id"]) == stored


def test_a_repeated_request_is_the_same_submission_whatever_its_outputs(app, url, plain, full):
    key = {"Idempotency_Key": str(uuid.uuid4())}
    ids = {
        upload(app, content, **key)[1]["id"]
        for content in (full, full, with_outputs(plain, "another picture"))
    }
    assert len(ids) == 1
    assert upload(app, plain.replace(b"I", b"J"), **key)[0] == 422


def test_an_outputless_notebook_and_a_script_are_stored_to_the_byte(app, url, plain):
    bare = json.dumps(json.loads(plain) | {"metadata": {}}, indent=3)
    for content, name in ((bare.encode(), "a.ipynb"), (b"x = 1\r\n", "a.py")):
        assert source(url, upload(app, content, name)[1]["id"]).encode() == content


LARGE = {"cell_type": "code", "source": "x" * 20 * KIB}


@pytest.mark.parametrize(
    ("content", "name", "why"),
    [
        (b"x" * (20 * KIB + 1), "a.py", "it has 21 KiB and at most 20 KiB are accepted; remove data"),
        (b"x" * 300 * KIB, "a.py", "it has 300 KiB and at most 20 KiB are accepted; remove data"),
        (
            with_outputs(json.dumps({"cells": [LARGE], "nbformat": 4}).encode()),
            "a.ipynb",
            "without outputs it has 21 KiB and at most 20 KiB are accepted",
        ),
        (
            b" " * 60 * MIB,
            "a.ipynb",
            "larger than 16 MiB: clear the outputs of the notebook (in Jupyter: Edit, Clear Outputs",
        ),
    ],
    ids=["small body", "large body", "notebook", "upload"],
)
def test_what_is_too_large_says_what_to_do(app, content, name, why):
    status, problem = upload(app, content, name)
    assert (status, problem["type"]) == (413, "urn:polhode:problem:too-large") and why in problem["detail"]


@pytest.mark.slow
def test_large_bodies_are_parsed_in_one_other_process_and_small_ones_here(database_url, new_app, plain):
    sql(database_url, "INSERT INTO worker (name, isolation) VALUES ('w', 'namespaces')")
    app, before = new_app(database_url=database_url, identity="local"), set(multiprocessing.active_children())
    assert upload(app, plain)[0] == 202 and set(multiprocessing.active_children()) == before
    hostile = b'{"source": "", "x": [' + b"[]," * MIB + b"[]]}"
    with ThreadPoolExecutor(10) as pool:  # more than have a place at a time
        answers = list(pool.map(lambda content: post(app, content)[0], [hostile] * 5 + [b"[" * MIB] * 6))
    assert answers == [422] * 5 + [400] * 6 and len(set(multiprocessing.active_children()) - before) == 1
    app.stop()
    assert set(multiprocessing.active_children()) == before


class Sending:
    """A request of ``body``, of which the last part is sent when ``go_on`` is set."""

    def __init__(self, body, go_on):
        self._parts, self._go_on = [body[: 300 * KIB], body[300 * KIB :]], go_on
        self.headers = {"content-type": "application/json"}

    async def stream(self):
        yield self._parts[0]
        await self._go_on.wait()
        yield self._parts[1]


def test_bodies_that_arrive_slowly_keep_nobody_else_waiting(rigid_body):
    body = json.dumps({"source": f"x = 1 #{'x' * 400 * KIB}"}).encode()

    async def main():
        large, never, at_once = LargeBodies(Settings(submission_kib=500)), asyncio.Event(), asyncio.Event()
        at_once.set()

        def parse(person, go_on):
            return asyncio.create_task(parse_submission(Sending(body, go_on), rigid_body, person, large))

        tasks = [parse(f"student {k // 3}", never) for k in range(3 * MOST_LARGE)]
        await asyncio.sleep(0.1)
        try:
            submission = await asyncio.wait_for(parse("ann", at_once), 20.0)
            tasks.append(another := parse("student 0", at_once))
            await asyncio.wait({another}, timeout=0.5)
            return submission, another.done()
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            large.process.stop()

    submission, done = asyncio.run(main())
    assert submission.source.startswith("x = 1") and not done


@pytest.mark.slow
def test_the_kit_and_the_server_agree_on_the_text(real_server, full, tmp_path, monkeypatch):
    (tmp_path / "mine.ipynb").write_bytes(full)
    report = polhode.submit(
        file=tmp_path / "mine.ipynb", exercises="2", server=real_server.url, assignment="rigid-body"
    )
    assert report.passed and not report.remark
    status, uploaded = upload(real_server, full, Prefer="wait=60")
    assert status == 200 and uploaded["sha256"] == report.sent.sha256 and uploaded["report"]["passed"]
