"""A student requests a regrade and the staff answers; the staff comments on lines of the source, and the
student answers.
"""

import html
import re

import pytest

from service.grading.submission import Submission
from service.pages.submission.source_view import MOST_LINES, cells
from service.store.course.comments import Comment
from tests.support.database import entered, run
from tests.support.http_client import Browser
from tests.support.submissions import hand_in

LIST = "/assignments/rigid-body/regrade-requests"
WHY = "my number is <b>right</b>"
EVIL = "why not <script>alert(1)</script>?"


@pytest.fixture(scope="module")
def browsers(server, url):
    people = {"ann": "student", "tutor": "assistant"}
    return {name: Browser(server).log_in(token=entered(url, name, role)) for name, role in people.items()}


@pytest.fixture
def page(url):
    """The path of Ann's graded submission, a source of two lines."""
    return f"/submissions/{run(url, lambda database: hand_in(database, 'ann', {'2-energy': '✗'}))}"


def test_a_request_its_answer_and_what_the_student_reads(browsers, page):
    ann, tutor = browsers["ann"], browsers["tutor"]
    assert "Request a regrade" in ann.open(page)[1] and "Request a regrade" not in tutor.open(page)[1]
    status, shown = ann.send(f"{page}/regrade-requests", page, reason=WHY)
    assert status == 200 and ann.at == f"{page}#regrade-requests" and html.escape(WHY) in shown
    assert "has not answered yet" in shown and "Request a regrade" not in shown
    assert re.search(r'regrade-requests">\s*1 regrade request<', tutor.open("/")[1])
    listed = tutor.open(LIST)[1]
    (action,) = re.findall(rf'action="({LIST}/[^"]+/answer)"', listed)
    own_action = action.replace(LIST, f"{page}/regrade-requests")
    assert own_action in tutor.open(page)[1] and own_action not in shown
    status, shown = tutor.send(action, LIST, answer="no, see <i>here</i>", status="declined")
    assert status == 200 and tutor.at == LIST, "no other request is open"
    read = ann.open(page)[1]
    assert (
        "<b>Declined</b> by tutor" in read
        and "no, see &lt;i&gt;here&lt;/i&gt;" in read
        and "Request a regrade" in read
    )
    own = ann.open("/assignments/rigid-body")[1]
    assert f'<a href="{page}#regrade-requests">regrade request declined</a>' in own
    assert action not in tutor.open(LIST)[1] and "regrade request<" not in tutor.open("/")[1]
    assert "declined the regrade request for" in tutor.open(f"/audit?subject={page.rsplit('/', 1)[1]}")[1]


def test_a_request_is_about_a_check_and_the_next_one_follows_its_answer(browsers, page, url):
    ann, tutor = browsers["ann"], browsers["tutor"]
    shown = ann.open(page)[1]
    assert '<option value="2-energy">2: rotational energy conserved' in shown
    status, shown = ann.send(f"{page}/regrade-requests", page, reason=WHY, check="no-such")
    assert status == 422 and "the report has no check no-such: choose another" in shown
    assert ann.send(f"{page}/regrade-requests", page, reason=WHY, check="2-energy")[0] == 200
    label = "2: rotational energy conserved (torque-free)"
    assert f'<a href="#check-2-energy">{label}</a>' in ann.open(page)[1]
    other = f"/submissions/{run(url, lambda database: hand_in(database, 'ann', {'2-energy': '✗'}))}"
    assert ann.send(f"{other}/regrade-requests", other, reason="too")[0] == 200
    listed = tutor.open(LIST)[1]
    assert f'<a href="{page}#check-2-energy">{label}</a>' in listed and "The whole submission" in listed
    first, second = re.findall(rf'action="{LIST}/([^"]+)/answer"', listed)
    tutor.send(f"{LIST}/{first}/answer", LIST, answer="yes", status="accepted")
    assert tutor.at == f"{LIST}#request-{second}"
    tutor.send(f"{LIST}/{second}/answer", LIST, answer="no", status="declined")
    assert tutor.at == LIST


@pytest.mark.parametrize(
    ("fields", "message"), [({"reason": " "}, "enter the reason"), ({"reason": "x" * 2001}, "at most 2000")]
)
def test_a_reason_is_required(browsers, page, fields, message):
    status, shown = browsers["ann"].send(f"{page}/regrade-requests", page, **fields)
    assert status == 422 and message in shown


def test_an_answer_is_a_decision_with_words(browsers, page):
    browsers["ann"].send(f"{page}/regrade-requests", page, reason=WHY)
    (action,) = re.findall(
        rf'action="({page}/regrade-requests/[^"]+/answer)"', browsers["tutor"].open(page)[1]
    )
    for fields, message in (
        ({"answer": "so"}, "accept or decline"),
        ({"answer": "", "status": "accepted"}, "enter the answer"),
    ):
        status, shown = browsers["tutor"].send(action, page, **fields)
        assert status == 422 and message in shown


def test_a_submission_that_is_not_graded_has_no_form(browsers, url):
    waiting = run(url, lambda database: hand_in(database, "ann", None))
    assert "Request a regrade" not in browsers["ann"].open(f"/submissions/{waiting}")[1]


def test_a_comment_stands_at_its_line_until_it_is_deleted(browsers, page):
    ann, tutor = browsers["ann"], browsers["tutor"]
    assert f"{page}/comments" not in ann.open(page)[1]
    status, shown = tutor.send(f"{page}/comments", page, cell="1", line="2", comment=EVIL)
    assert status == 200 and tutor.at == f"{page}#line-1-2"
    read = ann.open(page)[1]
    line = re.search(
        r'id="line-1-2" data-line="2">    return w\n</span><span class="comment"[^>]*>(.*?)<span',
        read,
        re.DOTALL,
    )
    assert line[1].strip() == "why not &lt;script&gt;alert(1)&lt;/script&gt;?" and "/delete" not in read
    assert f'<a href="{page}#source">1 comment</a>' in ann.open("/assignments/rigid-body")[1]
    (action,) = re.findall(r'action="([^"]+/delete)"', shown)
    assert tutor.send(action, page)[0] == 200 and "alert(1)" not in ann.open(page)[1]


def test_a_student_answers_a_comment_and_the_staff_reads_it(browsers, page):
    ann, tutor = browsers["ann"], browsers["tutor"]
    shown = tutor.send(f"{page}/comments", page, cell="1", line="2", comment="which $\\omega$?")[1]
    (action,) = re.findall(r'action="([^"]+/answer)"', shown)
    status, shown = ann.send(action, page, answer=" ")
    assert status == 422 and "enter the answer" in shown
    status, shown = ann.send(action, page, answer="the **first** <script>")
    assert status == 200 and ann.at == f"{page}#line-1-2"
    answer = "the <strong>first</strong> &lt;script&gt;"
    assert shown.count(answer) == 2, "beside its line, and in the list"
    assert answer in tutor.open(LIST)[1] and f'"{page}#line-1-2"' in tutor.open(LIST)[1]
    assert len(re.findall(r'action="([^"]+/answer)"', shown)) == 1, "one form below the comments on a line"


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"line": "3", "comment": "c"}, "has no line 3: its last one is 2"),
        ({"line": "x", "comment": "c"}, "must be a whole number"),
        ({"line": "1", "comment": ""}, "enter the comment"),
        ({"line": "1", "cell": "9", "comment": "c"}, "has no code cell 9"),
    ],
)
def test_a_comment_needs_words_and_an_existing_line(browsers, page, fields, message):
    status, shown = browsers["tutor"].send(f"{page}/comments", page, **{"cell": "1", **fields})
    assert status == 422 and message in shown


def test_comments_and_answers_have_markdown(browsers, page):
    ann, tutor = browsers["ann"], browsers["tutor"]
    tutor.send(f"{page}/comments", page, cell="1", line="1", comment="use `np.cross` <script>")
    ann.send(f"{page}/regrade-requests", page, reason="**right**")
    shown = tutor.open(page)[1]
    assert shown.count("use <code>np.cross</code> &lt;script&gt;") == 2 and "<strong>right</strong>" in shown


def test_a_commented_line_of_a_long_source_is_shown():
    source, far = Submission("x = 1\n" * (MOST_LINES + 500)), MOST_LINES + 100
    assert len(cells(source, {})[0].lines) == MOST_LINES
    (shown,) = cells(source, {}, [Comment(None, 1, far, "c", "prof", None)])
    assert len(shown.lines) == far and shown.lines[-1].comments[0].comment == "c"
