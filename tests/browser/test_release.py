"""A click path: an instructor holds scores back, sets the time zone, finds a student, writes a note, and
releases the scores.
"""

import pytest

from tests.support.database import run
from tests.support.submissions import hand_in

pytestmark = pytest.mark.slow  # tests/service/pages/course/test_settings.py has the requests of each step
BASE = "/assignments/rigid-body"


def test_scores_are_held_back_and_released(seen_by, application, url):
    verdicts = {"2-energy": "✗", "2-momentum": "✓"}
    path = f"/submissions/{run(url, lambda database: hand_in(database, 'ann', verdicts))}"
    ann, prof = seen_by("ann", "student", path), seen_by("prof", "instructor", f"{BASE}/class/settings")
    assert "1 of 36, +0 of 6 bonus points" in " ".join(ann.locator("main").inner_text().split())
    prof.get_by_label("Scores and reports").select_option("manually")
    prof.get_by_role("button", name="Save release").click()
    prof.get_by_role("button", name="Release scores now").wait_for()
    ann.reload()
    ann.get_by_text("have not been released yet").wait_for()
    assert "1 of 36" not in ann.locator("main").inner_text() and not ann.locator(".outcomes").count()

    prof.goto(f"{application.url}/settings")
    prof.get_by_label("Time zone").fill("Europe/Berlin")
    prof.get_by_role("button", name="Save").click()
    prof.get_by_text("Course settings saved.").wait_for()
    search = prof.get_by_role("searchbox", name="Search people")
    search.fill("ann")
    search.press("Enter")
    prof.locator("main").get_by_role("link", name="ann", exact=True).first.click()
    prof.get_by_label("New note").fill("asked for more time")
    prof.get_by_role("button", name="Save note").click()
    prof.get_by_text("asked for more time").wait_for()

    prof.goto(f"{application.url}{BASE}/class/settings")
    prof.get_by_role("button", name="Release scores now").click()
    prof.get_by_role("button", name="Withdraw the release of scores").wait_for()
    ann.reload()
    shown = " ".join(ann.locator("main").inner_text().split())
    assert "1 of 36, +0 of 6 bonus points" in shown and (
        "CET" in shown or "CEST" in shown or "Berlin" in shown
    )
