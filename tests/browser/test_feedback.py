"""A click path of feedback: a student requests a regrade, an assistant answers and comments on a line, the
student reads both.
"""

import pytest

from tests.support.database import run
from tests.support.submissions import hand_in

pytestmark = pytest.mark.slow  # tests/service/pages has the requests of each step


def test_a_request_an_answer_and_a_comment(page, seen_by, application, url):
    page.allowed.append("status of 422")
    path = f"/submissions/{run(url, lambda database: hand_in(database, 'ann', {'2-energy': '✗'}))}"
    ann, tutor = seen_by("ann", "student", path), seen_by("tutor", "assistant", "/")
    ann.get_by_text("Request a regrade").first.click()
    ann.get_by_label("Reason").fill("check 2-energy: my units are J")
    ann.get_by_role("button", name="Request a regrade").click()
    ann.get_by_text("has not answered yet").wait_for()

    tutor.reload()
    tutor.get_by_role("link", name="1 regrade request").click()
    tutor.get_by_label("Answer").fill("the unit is not the cause")
    tutor.get_by_role("button", name="Decline").click()
    tutor.get_by_label("Answer").wait_for(state="detached")  # the next request would be here
    tutor.goto(application.url + path)
    tutor.locator('[data-cell="1"] [data-line="2"]').click()
    line, comment = tutor.get_by_label("Line", exact=True), tutor.get_by_label("Comment (")
    assert line.input_value() == "2" and comment.evaluate("field => field === document.activeElement")
    line.fill("7")
    comment.fill("w is not its derivative")
    tutor.get_by_role("button", name="Save comment").click()
    tutor.locator("#refused").wait_for()
    assert (
        "no line 7" in tutor.locator("#refused").inner_text()
        and comment.input_value() == "w is not its derivative"
    )
    line.fill("2")
    tutor.get_by_role("button", name="Save comment").click()
    tutor.locator("#line-1-2 + .comment").wait_for()
    assert tutor.evaluate("scrollY") > 0

    ann.goto(application.url + path)
    assert "Declined by tutor" in ann.locator("#regrade-requests").inner_text()
    assert "w is not its derivative" in ann.locator("#line-1-2 + .comment").inner_text()
    assert (
        not ann.get_by_role("button", name="Delete").count()
        and not ann.get_by_text("Comment on a line").count()
    )
