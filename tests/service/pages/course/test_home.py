"""A draft, of which students see nothing, and an assignment that is not yet available, of which they see the
title and the date; the staff sees it all.
"""

import json
from datetime import UTC, datetime, timedelta

import pytest

from service.store.course import assignment_settings
from service.store.people import people
from service.store.schema import migrate
from tests.support.database import entered, new_database, run
from tests.support.http_client import call

SLUG, TITLE = "rigid-body", "Rigid-Body Rotation"
CARD = f'href="/assignments/{SLUG}"'
OPENS = datetime(2099, 3, 1, 12, tzinfo=UTC)
OF_STUDENTS = (
    f"/assignments/{SLUG}",
    f"/assignments/{SLUG}/notebook",
    f"/v1/assignments/{SLUG}",
    f"/v1/assignments/{SLUG}/kit",
    f"/v1/assignments/{SLUG}/notebook.ipynb",
    f"/v1/assignments/{SLUG}/submissions",
)


@pytest.fixture(scope="module")
def url(postgres):
    url = new_database(postgres.url, "polhode")

    async def fill(database):
        async with database.begin() as connection:
            await people.enroll(
                connection, [("prof", "instructor"), ("helper", "assistant"), ("ann", "student")]
            )

    run(url, fill)
    return url


@pytest.fixture
def available(url):
    """``available(time)`` sets the time from which the assignment is available."""

    def set_time(moment):
        changes = {"available_from": moment}
        run(url, lambda database: assignment_settings.change(database, SLUG, changes, "prof"))

    yield set_time
    set_time(None)


@pytest.fixture
def draft(url):
    """The assignment is a draft."""

    def publish(yes):
        run(url, lambda database: assignment_settings.change(database, SLUG, {"published": yes}, "prof"))

    publish(False)
    yield
    publish(True)


def statuses(server, url, who):
    """The statuses of what the person gets at each address of students."""
    token = f"Bearer {entered(url, who, role=None)}"
    return {call(server, path, Authorization=token)[0] for path in OF_STUDENTS}


def submit(server, url, who):
    status, _, answer = call(
        server,
        f"/v1/assignments/{SLUG}/submissions",
        json.dumps({"source": "x = 1"}).encode(),
        Content_Type="application/json",
        Authorization=f"Bearer {entered(url, who, role=None)}",
    )
    return status, json.loads(answer)


def test_students_see_title_and_date_and_nothing_else(server, looks, available, url):
    available(OPENS)
    status, page, _ = looks("ann", "/")
    assert status == 200 and TITLE in page and "Not yet available" in page and "2099-03-01" in page
    assert f"/assignments/{SLUG}" not in page
    for path in OF_STUDENTS:
        status, told, _ = looks("ann", path)
        assert status == 403 and "2099-03-01 12:00 UTC" in told and "euler_eqs" not in told, path
    status, problem = submit(server, url, "ann")
    assert (status, problem["type"]) == (403, "urn:polhode:problem:not-available")
    assert problem["detail"].endswith("is available from 2099-03-01 12:00 UTC: come back then")


def test_without_a_login_it_is_not_available_either(server, available):
    available(OPENS)
    for path in (f"/v1/assignments/{SLUG}", f"/v1/assignments/{SLUG}/kit"):
        assert call(server, path)[0] == 403
    (listed,) = [one for one in json.loads(call(server, "/v1/assignments")[2]) if one["slug"] == SLUG]
    assert listed["available_from"] == OPENS.isoformat() and TITLE in listed["title"]


def test_the_staff_sees_and_tries_it(server, looks, available, url):
    available(OPENS)
    for who in ("prof", "helper"):
        assert f"/assignments/{SLUG}/class" in looks(who, "/")[1]
        assert statuses(server, url, who) == {200}
        assert submit(server, url, who)[0] == 202


def test_it_opens_by_itself(server, looks, available, url):
    available(datetime.now(UTC) - timedelta(seconds=1))
    assert "Not yet available" not in looks("ann", "/")[1]
    assert statuses(server, url, "ann") == {200}
    assert submit(server, url, "ann")[0] == 202


def test_an_instructor_sets_it_in_the_time_zone_of_the_course(looks, available, url):
    at = f"/assignments/{SLUG}/class/settings"
    fields = {"available_from": "2099-05-01T08:00", "due": "", "grace": "", "most": "", "weight": ""}
    assert looks("prof", f"/assignments/{SLUG}/rules", at=at, **fields)[0] == 200
    assert 'value="2099-05-01T08:00"' in looks("prof", at)[1]
    assert "2099-05-01" in looks("ann", "/")[1]
    status, page, _ = looks("prof", f"/assignments/{SLUG}/rules", at=at, **fields | {"available_from": "x"})
    assert status == 422 and "expected a date and time" in page


def test_students_see_nothing_of_a_draft(server, looks, draft, url):
    assert CARD not in looks("ann", "/")[1]
    assert statuses(server, url, "ann") == {404}
    status, problem = submit(server, url, "ann")
    assert (status, problem["detail"]) == (404, f"no assignment {SLUG}: check the address")
    for headers in ({}, {"Authorization": f"Bearer {entered(url, 'ann', role=None)}"}):
        listed = json.loads(call(server, "/v1/assignments", **headers)[2])
        assert listed and SLUG not in {one["slug"] for one in listed}
        assert call(server, f"/v1/assignments/{SLUG}/kit", **headers)[0] == 404


def test_the_staff_sees_and_tries_a_draft_which_does_not_count(server, looks, draft, url):
    for who in ("prof", "helper"):
        page = looks(who, "/")[1]
        assert page.index("<h2>Drafts</h2>") < page.index(TITLE)
        assert statuses(server, url, who) == {200}
        headers = {"Authorization": f"Bearer {entered(url, who, role=None)}"}
        assert SLUG in {one["slug"] for one in json.loads(call(server, "/v1/assignments", **headers)[2])}
    assert submit(server, url, "prof")[0] == 202
    assert f"{SLUG} points" not in looks("prof", "/grades.csv")[1]
    assert SLUG in looks("prof", f"/assignments/{SLUG}/grades.json")[1]


def test_an_instructor_publishes_a_draft(looks, draft):
    at = f"/assignments/{SLUG}/class/settings"
    fields = {"due": "", "grace": "", "most": "", "weight": ""}
    assert looks("prof", f"/assignments/{SLUG}/rules", at=at, published="yes", **fields)[0] == 200
    assert CARD in looks("ann", "/")[1]
    assert looks("prof", f"/assignments/{SLUG}/rules", at=at, **fields)[0] == 200
    assert CARD in looks("ann", "/")[1], "a form without the field leaves it as it is"


def test_a_new_assignment_is_a_draft(empty_url):
    migrate(empty_url)
    assert run(empty_url, assignment_settings.unavailable)[SLUG] is None
