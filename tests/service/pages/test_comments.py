"""The staff comments on lines of a source; the student reads the comments beside them."""

import re

import pytest

from service.grading.submission import Submission
from service.pages.source_view import MOST_LINES, cells
from service.store.course.comments import Comment
from tests.support.database import entered, run
from tests.support.http_client import Browser
from tests.support.submissions import hand_in

EVIL = "why not <script>alert(1)</script>?"


@pytest.fixture(scope="module")
def browsers(server, url):
    people = {"ann": "student", "tutor": "assistant"}
    return {name: Browser(server).log_in(token=entered(url, name, role)) for name, role in people.items()}


@pytest.fixture
def page(url):
    """The path of Ann's graded submission, a source of two lines."""
    return f"/submissions/{run(url, lambda database: hand_in(database, 'ann', {'2-energy': '✗'}))}"


def test_a_comment_stands_at_its_line_until_it_is_deleted(browsers, page):
    ann, tutor = browsers["ann"], browsers["tutor"]
    assert f"{page}/comments" not in ann.open(page)[1]
    status, shown = tutor.send(f"{page}/comments", page, cell="1", line="2", comment=EVIL)
    assert status == 200 and tutor.at == f"{page}#line-1-2"
    read = ann.open(page)[1]
    line = re.search(r'id="line-1-2" data-line="2">    return w\n</span><span class="comment"[^>]*>(.*?)<span', read, re.DOTALL)
    assert line[1].strip() == "why not &lt;script&gt;alert(1)&lt;/script&gt;?" and "/delete" not in read
    (action,) = re.findall(r'action="([^"]+/delete)"', shown)
    assert tutor.send(action, page)[0] == 200 and "alert(1)" not in ann.open(page)[1]


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


def test_a_commented_line_of_a_long_source_is_shown():
    source, far = Submission("x = 1\n" * (MOST_LINES + 500)), MOST_LINES + 100
    assert len(cells(source, [])[0].lines) == MOST_LINES
    (shown,) = cells(source, [], [Comment(None, 1, far, "c", "prof", None)])
    assert len(shown.lines) == far and shown.lines[-1].comments[0].comment == "c"
