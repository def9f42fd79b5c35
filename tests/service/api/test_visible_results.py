"""No route gives a student what has not been released.

Two students sent the same code at the same time and got different reports. Before the release, every answer
to one of them must be that to the other but for names, ids and times.
"""

import json
import re
import uuid
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import pytest
from fastapi.routing import APIRoute

from polhode.judging.outcome import Diagnosis, Ended, ExerciseReport, Picture, SceneEnd
from polhode.judging.verdict import RowsRight
from service import app
from service.api import figures
from service.store.course import assignment_settings, overrides
from service.store.queue import runs
from service.store.submissions.accepting import accept
from tests.support.database import entered, new, new_database, run, sql
from tests.support.http_client import call
from tests.support.reports import ASSIGNMENT, SLIP, outcome, report

SLUG = "rigid-body"
SECRET = "a secret of the hidden checks"
HIDDEN = next(scene.name for scene in ASSIGNMENT.scenes if callable(scene.inputs))
PUBLIC = next(scene.name for scene in ASSIGNMENT.scenes if not callable(scene.inputs))
FIGURE = next(f for e in ASSIGNMENT.exercises for f in e.figures)
VALUES = {
    "slug": SLUG,
    "name": FIGURE.name,
    "form": "svg",
    "number": "0",
    "kind": "stability",
    "override": "1",
}
TIMES = re.compile(
    r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d(:\d\d(\.\d+)?)?(\+00:00|Z)?|\d+(\.\d+)? (ms|s|min|h)\b|[0-9a-f]{64}"
)


def made(right, secret=None):
    """A report of three checks, of which the second is hidden."""
    hidden = {
        "hidden": True,
        "measured": float(right),
        "where": secret,
        "partial": RowsRight(1, 2),
        "points": 2,
    }
    hidden |= {
        "hints": [secret or "none"],
        "remarks": [secret or "none"],
        "detail": secret or "got 2",
        "margin": 0.1 + right,
    }
    likely = [SLIP if secret is None else Diagnosis("raises", secret, 1.0)]
    outcomes = [outcome("2-energy", "pass" if right else "fail", "energy")]
    outcomes += [
        outcome("2-hidden", "pass" if right else "fail", "hidden", diagnosis=likely, **hidden),
        outcome("2-momentum"),
    ]
    end = Ended.RAISED if secret else Ended.FINISHED
    return report(
        exercises=[ExerciseReport("2", "Two", outcomes)],
        figures=[Picture(FIGURE.name, "2", "Angular velocity", "ω")],
        scene_ends=[SceneEnd(HIDDEN, end, secret or "", None, secret), SceneEnd(PUBLIC, Ended.FINISHED, "")],
        stdout=secret or "",
        total=36,
    )


async def send(database, person, graded):
    one = new(person)
    await accept(database, one)
    (grading,) = await database.rows("SELECT id FROM grading WHERE submission_id = %(id)s", {"id": one.id})
    claimed = await runs.claim(database, grading.id, uuid.uuid4(), "w")
    assert await runs.finish(database, claimed, replace(graded), {})
    return one.id


@pytest.fixture(scope="module")
def url(postgres):
    return new_database(postgres.url, "polhode")


@pytest.fixture(autouse=True)
def no_worker_is_waited_for(monkeypatch):
    monkeypatch.setattr(figures, "SWEEP_WAIT_S", 0.1)


@pytest.fixture(scope="module")
def sent(url):
    """Id and token of submissions by student: ann and ben have other scores, cid and dan other details of a
    hidden check.
    """

    async def fill(database):
        reports = {"ann": made(True), "ben": made(False), "cid": made(False), "dan": made(False, SECRET)}
        return {name: await send(database, name, one) for name, one in reports.items()}

    return {name: (str(id), entered(url, name)) for name, id in run(url, fill).items()}


def paths():
    """Every address that answers GET and names a submission or an assignment, and the front page."""
    for router in (*app.ROUTERS, *app.PAGES):
        for route in router.routes:
            if (
                isinstance(route, APIRoute)
                and "GET" in route.methods
                and (route.path == "/" or "{id}" in route.path)
            ):
                yield route.path
    yield from ("/assignments/{slug}", "/v1/assignments/{slug}/submissions")


def answer(server, sent, path, who):
    """Status and body of what the student gets, without what differs between any two students."""
    id, token = sent[who]
    filled = re.sub(r"\{(\w+)(?::\w+)?\}", lambda part: {"id": id, **VALUES}.get(part[1], "1"), path)
    status, _, body = call(
        server, filled, Authorization=f"Bearer {token}", Accept="text/html,application/json"
    )
    text = body.decode().replace(id, "ID").replace(who, "WHO")
    return status, TIMES.sub("T", re.sub(r"[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}", "ID", text))


def release(url, **modes):
    modes = {"scores": "immediately", "details": "immediately"} | modes
    releases = {f"{what}_release": mode for what, mode in modes.items()}
    run(url, lambda d: assignment_settings.change(d, SLUG, releases, "prof"))


ALL = sorted(set(paths()))


def test_the_routes_are_those_of_a_submission():
    assert len(ALL) > 12 and "/v1/submissions/{id}/events" in ALL and "/v1/submissions/{id}/report.txt" in ALL


@pytest.mark.parametrize("path", ALL)
def test_no_route_gives_scores_before_their_release(server, url, sent, path):
    release(url, scores="manually")
    withheld = answer(server, sent, path, "ann")
    assert withheld == answer(server, sent, path, "ben") and withheld[0] != 500
    release(url, scores="manually", details="manually")
    assert answer(server, sent, path, "ann") == withheld or "details" in answer(server, sent, path, "ann")[1]


@pytest.mark.parametrize("path", ALL)
def test_no_route_gives_details_of_hidden_checks_before_their_release(server, url, sent, path):
    release(url, details="manually")
    withheld = answer(server, sent, path, "dan")
    assert SECRET not in withheld[1] and withheld == answer(server, sent, path, "cid") and withheld[0] != 500


def test_released_scores_and_details_are_given(server, url, sent):
    release(url)
    shown = {path for path in ALL if answer(server, sent, path, "ann") != answer(server, sent, path, "ben")}
    assert {"/", "/assignments/{slug}", "/submissions/{id}", "/v1/submissions/{id}",
        "/v1/submissions/{id}/events",
            "/v1/submissions/{id}/report.txt", "/v1/assignments/{slug}/submissions"} <= shown  # fmt: skip
    assert {path for path in ALL if SECRET in answer(server, sent, path, "dan")[1]} >= {
        "/submissions/{id}", "/v1/submissions/{id}", "/v1/submissions/{id}/report.txt"}  # fmt: skip


def document(server, sent, who, token=None):
    id, own = sent[who]
    return json.loads(call(server, f"/v1/submissions/{id}", Authorization=f"Bearer {token or own}")[2])


def test_verdicts_and_points_of_hidden_checks_are_no_details(server, url, sent):
    release(url, details="manually")
    told = document(server, sent, "dan")["report"]
    (hidden,) = [o for e in told["exercises"] for o in e["outcomes"] if o["hidden"]]
    assert (hidden["verdict"], hidden["earned"], told["score"]) == ("fail", 1, 2) and told["provenance"][
        "seed"
    ] == 0
    assert hidden["remarks"] == ["the details of this check have not been released yet"]
    staff = document(server, sent, "dan", entered(url, "prof", "instructor"))
    assert SECRET in json.dumps(staff) and staff["report"]["provenance"]["seed"] == 7


def test_scores_are_released_by_hand_and_withheld_again(server, url, sent):
    release(url, scores="manually")
    for released in (False, True, False):
        run(
            url,
            lambda d, on=released: assignment_settings.release(
                d, SLUG, scores=on, details=None, actor="prof"
            ),
        )
        told = document(server, sent, "ann")
        assert (told["report"] is not None, told.get("scores_released", True)) == (released, released)
        assert told["status"] == "graded"
        status, _, body = call(
            server, f"/v1/submissions/{sent['ann'][0]}/report.txt", Authorization=f"Bearer {sent['ann'][1]}"
        )
        assert status == (200 if released else 409) and (released or b"have not been released yet" in body)


def test_scores_are_released_at_the_own_deadline(server, url, sent):
    """With the extension and the grace period; without a deadline never."""
    release(url, scores="deadline")
    now = datetime.now(UTC)
    extended = (
        "INSERT INTO extension (assignment_id, person_id, due_at, reason, given_by) SELECT a.id, p.id, %s,"
        " 'ill', 'prof' "
    )
    sql(
        url,
        extended + "FROM assignment a, person p WHERE a.slug = %s AND p.name = 'ben'",
        now + timedelta(days=1),
        SLUG,
    )
    for due, grace, ann in (
        (None, 0, False),
        (now - timedelta(hours=1), 7200, False),
        (now - timedelta(hours=3), 7200, True),
    ):
        run(
            url,
            lambda d, rules={"due_at": due, "grace_s": grace}: assignment_settings.change(
                d, SLUG, rules, "prof"
            ),
        )
        assert (document(server, sent, "ann")["report"] is not None) == ann
        assert document(server, sent, "ben")["report"] is None
    sql(url, "DELETE FROM extension")
    run(url, lambda d: assignment_settings.change(d, SLUG, {"due_at": None, "grace_s": 0}, "prof"))


def test_overrides_are_withheld_with_the_scores(server, url, sent):
    run(
        url,
        lambda d: overrides.give(d, uuid.UUID(sent["ann"][0]), "prof", check=None, points=0.5, reason=SECRET),
    )
    release(url, scores="manually")
    for path in ALL:
        assert SECRET not in answer(server, sent, path, "ann")[1], path
    release(url)
    assert (
        document(server, sent, "ann")["points"] == 0.5
        and SECRET in answer(server, sent, "/submissions/{id}", "ann")[1]
    )
    sql(url, "UPDATE override SET withdrawn_at = now(), withdrawn_by = 'prof'")
