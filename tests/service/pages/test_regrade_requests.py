"""A student requests a regrade on the page of the submission; the staff answers on the list."""

import html
import re

import pytest

from tests.support.database import entered, run
from tests.support.http_client import Browser
from tests.support.submissions import hand_in

LIST = "/assignments/rigid-body/regrade-requests"
WHY = "my number is <b>right</b>"


@pytest.fixture(scope="module")
def browsers(server, url):
    people = {"ann": "student", "tutor": "assistant"}
    return {name: Browser(server).log_in(token=entered(url, name, role)) for name, role in people.items()}


@pytest.fixture
def page(url):
    """The path of Ann's graded submission."""
    return f"/submissions/{run(url, lambda database: hand_in(database, 'ann', {'2-energy': '✗'}))}"


def test_a_request_its_answer_and_what_the_student_reads(browsers, page):
    ann, tutor = browsers["ann"], browsers["tutor"]
    assert "Request a regrade" in ann.open(page)[1] and "Request a regrade" not in tutor.open(page)[1]
    status, shown = ann.send(f"{page}/regrade-requests", page, reason=WHY)
    assert status == 200 and ann.at == f"{page}#regrade-requests" and html.escape(WHY) in shown
    assert "has not answered yet" in shown and "Request a regrade" not in shown
    assert re.search(r'regrade-requests">\s*1 regrade request<', tutor.open("/")[1])
    listed = tutor.open(LIST)[1]
    (action,) = re.findall(r'action="(/regrade-requests/[^"]+/answer)"', listed)
    assert action in tutor.open(page)[1] and action not in shown
    status, shown = tutor.send(action, LIST, answer="no, see <i>here</i>", status="declined")
    assert status == 200 and tutor.at == f"{page}#regrade-requests"
    read = ann.open(page)[1]
    assert "<b>Declined</b> by tutor" in read and "no, see &lt;i&gt;here&lt;/i&gt;" in read and "Request a regrade" in read
    assert action not in tutor.open(LIST)[1] and "regrade request<" not in tutor.open("/")[1]
    assert "regrade request declined" in tutor.open(f"/audit?subject={page.rsplit('/', 1)[1]}")[1]


@pytest.mark.parametrize(("fields", "message"), [({"reason": " "}, "enter the reason"), ({"reason": "x" * 2001}, "at most 2000")])
def test_a_reason_is_required(browsers, page, fields, message):
    status, shown = browsers["ann"].send(f"{page}/regrade-requests", page, **fields)
    assert status == 422 and message in shown


def test_an_answer_is_a_decision_with_words(browsers, page):
    browsers["ann"].send(f"{page}/regrade-requests", page, reason=WHY)
    (action,) = re.findall(r'action="(/regrade-requests/[^"]+/answer)"', browsers["tutor"].open(page)[1])
    for fields, message in (({"answer": "so"}, "accept or decline"), ({"answer": "", "status": "accepted"}, "enter the answer")):
        status, shown = browsers["tutor"].send(action, page, **fields)
        assert status == 422 and message in shown


def test_a_submission_that_is_not_graded_has_no_form(browsers, url):
    waiting = run(url, lambda database: hand_in(database, "ann", None))
    assert "Request a regrade" not in browsers["ann"].open(f"/submissions/{waiting}")[1]
