"""Every page of a class of 500 weighs at most 150 kB without its figures, on the first visit."""

import pytest

from service.store.people import people
from tests.support.app import App
from tests.support.course_pages import fill
from tests.support.database import entered, run, sql

pytestmark = pytest.mark.slow  # bench.pages has the times
MOST_BYTES = 150_000
ONE_EACH = """
INSERT INTO submission (id, assignment_id, person_id, source, sha256, filename, fingerprint)
SELECT gen_random_uuid(), a.id, p.id, '', repeat('0', 64), 'work.py', '' FROM assignment a, person p
WHERE a.slug = 'rigid-body' AND p.name ~ '^student-'
"""


@pytest.fixture(scope="module")
def paths(url, sandbox):
    async def enroll(database):
        class_list = [
            (f"student-{k}", "student", f"Student Number {k}", f"student-{k}@example.org", f"{k:06}")
            for k in range(500)
        ]
        async with database.begin() as connection:
            await people.enroll(connection, class_list)

    filled = fill(url, sandbox)
    run(url, enroll)
    sql(url, ONE_EACH)
    return filled


@pytest.fixture(scope="module")
def server(url, paths):
    started = App(database_url=url)
    yield started
    started.stop()


def test_no_page_weighs_more_than_150_kb(page, server, url, paths):
    page.allowed += ["status of 404"]
    page, weights = page(), {}
    page.goto(f"{server.url}/login")
    page.get_by_label("Token from your course").fill(entered(url, "prof", "instructor"))
    page.get_by_role("button", name="Log in").click()
    page.locator("nav .me").wait_for()
    network, kinds, sizes = page.context.new_cdp_session(page), {}, {}
    network.send("Network.enable")
    network.send("Network.setCacheDisabled", {"cacheDisabled": True})
    network.on("Network.responseReceived", lambda event: kinds.update({event["requestId"]: event["type"]}))
    network.on(
        "Network.loadingFinished",
        lambda event: sizes.update({event["requestId"]: event["encodedDataLength"]}),
    )
    for what, path in paths.items():
        kinds.clear()
        sizes.clear()
        page.goto(server.url + path)
        page.locator("button.keys").wait_for()
        weights[what] = sum(size for id, size in sizes.items() if kinds.get(id) != "Image")
    assert weights["students"] > 10_000
    assert {what: weight for what, weight in weights.items() if weight > MOST_BYTES} == {}
