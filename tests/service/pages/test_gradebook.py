"""The pages of course, people and class, of a real server, as instructor, assistant and student."""

import json
import re
import urllib.parse

import pytest

from ecp.document import document
from ecp.outcome import Diagnosis, SweepResult, SweptPoint
from service.grading import charts
from service.pages import class_stats
from service.store.course import people
from service.store.course.gradebook import student_rows
from service.store.database import Database
from service.store.records import store_artefacts
from tests.support.database import new_database, run, sql
from tests.support.reports import ASSIGNMENT, SLIP
from tests.support.submissions import hand_in

OWN = "/assignments/rigid-body"
CLASS = f"{OWN}/class"
SETTINGS, STUDENTS = f"{CLASS}/settings", f"{CLASS}/students"
EVIL = "<script>alert(1)</script>\u202e"
RAISED = Diagnosis("raises", "ValueError: <img src=x onerror=alert(2)>", 1.0)


@pytest.fixture(scope="module")
def url(postgres):
    url = new_database(postgres.url, "polhode")

    async def fill(database):
        roster = [("prof", "instructor"), ("helper", "assistant"), ("zoe", "student", "Zoe <b>Adams</b>"), ("gone", "former")]
        async with database.begin() as connection:
            await people.enroll(connection, roster)
        await hand_in(database, "ann", {"2-energy": ("✓", 1.5), "2-momentum": "✓"}, filename="<b>a.py")
        await hand_in(database, "ben", {"2-energy": ("✗", 1e-3), "2-momentum": "⏱"})
        await hand_in(database, "cleo", {"2-energy": ("✗", 0.1, SLIP), "2-momentum": ("!", None, RAISED)})
        await hand_in(database, "dan", None)

    run(url, fill)
    return url


def test_the_course_tells_who_has_submitted_and_what_waits(looks):
    status, page, headers = looks("prof", "/")
    assert status == 200 and "<b>4/5</b> submitted" in page and "1 being graded" in page
    assert "default-src 'self'" in headers["content-security-policy"] and not re.search(r"\sstyle=|\son[a-z]+=", page)
    own = looks("ann", "/")[1]
    assert "being graded" not in own and "4/5" not in own and own.count("/submissions/") == 1


def test_the_class_has_tabs_each_a_page_of_its_own(looks):
    links = re.findall(r'href="([^"]+)"', re.search(r'<nav class="tabs".*?</nav>', looks("helper", CLASS)[1], re.DOTALL)[0])
    assert len(links) == 6
    for link in links:
        status, page, _ = looks("helper", link)
        assert status == 200 and page.count(f'<a href="{link}" aria-current="page">') == 1, link


def test_the_class_by_check(looks):
    page = looks("helper", STUDENTS)[1]
    assert page.count('<tr><th scope="row"><a href="/person?name=zoe">Zoe &lt;b&gt;Adams&lt;/b&gt;</a></th><td>–</td>') == 1
    rows = dict(re.findall(r'<tr><th scope="row"><a href="[^"]*">(\w+)</a></th><td><a[^>]*>(?:.*?)</td>(.*?)</tr>', page))
    marks = {name: re.findall(r'<td class="(\w+)">(.)</td>', cells) for name, cells in rows.items()}
    assert marks["ann"] == [("pass", "✓"), ("pass", "✓")] and marks["ben"] == [("fail", "✗"), ("timeout", "⏱")]
    assert marks["cleo"][1] == ("error", "!") and marks["dan"] == []
    assert page.count('<th scope="col"><a href') == len(ASSIGNMENT.checks())
    page = looks("helper", f"{CLASS}/checks")[1]
    assert "1 of 3 (33%)" in page and "! small" in page and "<img src=x" not in page
    assert "<img src=x" not in looks("helper", CLASS)[1]


def test_causes_by_number_of_students_lead_to_their_submissions(looks):
    page = looks("prof", CLASS)[1]
    link, count = re.search(r'href="(/assignments/[^"]*cause=[^"]*)">(\d+) student', page).groups()
    assert count == "2" and SLIP.sentence in page
    chosen = looks("prof", link.replace("&amp;", "&"))[1]
    assert "<h2>2 of 5 students</h2>" in chosen and "ben" in chosen and "cleo" in chosen and ">ann<" not in chosen
    by_check = looks("prof", f"{CLASS}/submissions?check=2-energy&state=not-pass")[1]
    assert "<h2>2 of 5" in by_check and "rotational energy conserved" in by_check
    assert "<h2>1 of 5" in looks("prof", f"{CLASS}/submissions?check=2-momentum&state=timeout")[1]
    assert "<h2>1 of 5" in looks("prof", f"{CLASS}/submissions?state=none")[1]
    evil = looks("prof", f"{CLASS}/submissions?cause={urllib.parse.quote(EVIL)}")[1]
    assert "<h2>0 of 5" in evil and "<script>alert" not in evil


def test_rules_and_extensions(looks, url):
    set_ = {"due": "2099-01-01T12:00", "grace": "15", "most": "9", "weight": "3"}
    assert looks("prof", "/assignments/rigid-body/rules", at=SETTINGS, **set_)[0] == 200
    page = looks("ann", "/")[1]
    assert 'datetime="2099-01-01T12:00:00+00:00"' in page and "15 min grace" in page
    ((others,),) = sql(url, "SELECT count(*) FROM assignment WHERE weight = 1 AND slug <> 'rigid-body'")
    first, *_ = re.findall(r"<tr>\n<th scope=\"row\">(.*?)</tr>", page, re.DOTALL)
    assert "Rigid-Body" in first and f"<td>{300 / (3 + others):.3g} %</td>" in first
    extend = "/assignments/rigid-body/extensions"
    assert "ill &lt;b&gt;" in looks("prof", extend, at=SETTINGS, name="zoe", due="2099-02-01T12:00", reason="ill <b>")[1]
    for fields in ({"name": "nobody", "due": "2099-02-01T12:00", "reason": "x"}, {"name": "zoe", "due": "soon", "reason": "x"},
                   {"name": "zoe", "due": "2099-02-01T12:00"}, {"name": "ben"},
                   {"name": "zoe", "due": "2020-02-01T12:00", "reason": "x"}):  # fmt: skip
        assert looks("prof", extend, at=SETTINGS, **fields)[0] == 422, fields
    assert looks("prof", "/assignments/rigid-body/rules", at=SETTINGS, due="", grace="-1")[0] == 422
    assert sql(url, "SELECT p.name, e.reason FROM extension e JOIN person p ON p.id = person_id") == [("zoe", "ill <b>")]
    assert "2099-02-01 12:00" in looks("zoe", OWN)[1] and "with your extension" in looks("zoe", OWN)[1]
    assert "with your extension" not in looks("ann", OWN)[1]
    page = looks("prof", extend, at=SETTINGS, name="zoe  <B>Adams</b>", due="")[1]
    undo = dict(re.findall(r'name="(name|due|reason)" value="([^"]*)"', page[page.index('class="notice"') :])[:3])
    assert undo == {"name": "zoe", "due": "2099-02-01T12:00:00+00:00", "reason": "ill &lt;b&gt;"} and ">Undo<" in page
    assert sql(url, "SELECT count(*) FROM extension") == [(0,)]
    assert looks("prof", extend, at=SETTINGS, **undo)[0] == 200 and sql(url, "SELECT count(*) FROM extension") == [(1,)]
    assert ">Undo<" not in looks("prof", f"{SETTINGS}?removed=zoe")[1]
    assert looks("prof", extend, at=SETTINGS, name="zoe", due="")[0] == 200
    assert sql(url, "SELECT count(*) FROM extension") == [(0,)]
    assert looks("prof", "/assignments/rigid-body/rules", at=SETTINGS, due="", grace="0", most="")[0] == 200


@pytest.mark.slow
def test_the_class_is_swept_once_and_drawn(looks, url):
    """Jobs for who has not been swept, however often it is asked for; the chart is of who has."""
    asked = "SELECT count(*) FROM procrastinate_jobs WHERE task_name = 'sweep'"
    assert looks("helper", f"{CLASS}/sweep.svg")[0] == 404 and "3 graded submissions have" in looks("helper", CLASS)[1]
    swept = SweepResult(charts.scenes(charts.load_work_precision())[0], [SweptPoint("DOP853", 1e-11, 1000, 1e-10, 0.01)], "fine")
    ann = sql(url, "SELECT a.id FROM grading a JOIN submission s ON s.id = submission_id WHERE s.filename = '<b>a.py'")[0][0]
    run(url, lambda database: store_artefacts(database, ann, {"sweep.json": json.dumps(document(swept)).encode()}))
    for _ in range(2):
        assert looks("helper", f"{CLASS}/sweep", at=CLASS)[0] == 200 and sql(url, asked)[0][0] == 2
    page, (status, chart, headers) = looks("helper", CLASS)[1], looks("helper", f"{CLASS}/sweep.svg")
    assert "1 functions of the class" in page and "2 graded submissions have" in page
    assert status == 200 and headers["content-type"].startswith("image/svg+xml") and "class, DOP853" in chart


def test_who_may_not_and_forms_without_their_token(looks, server):
    for path in (CLASS, STUDENTS, f"{CLASS}/checks", SETTINGS, f"{CLASS}/submissions", f"{CLASS}/sweep.svg", "/people"):
        status, page, headers = looks("ann", path)
        assert status == 403 and "staff" in page and headers["content-type"].startswith("text/html")
    for path in ("/assignments/rigid-body/rules", "/assignments/rigid-body/extensions", "/people"):
        assert looks("helper", path, at=f"{OWN}/regrades", name="zoe")[0] == 403
        status, page, _ = looks("prof", path, at=SETTINGS, csrf="0" * 64, name="zoe")
        assert status == 403 and "reload the page" in page


def test_a_page_asks_as_often_however_large_the_class_is(looks, url, monkeypatch):
    """No query per row: counted at the gradebook, whose rows make the page."""
    asked = []
    rows = Database.rows
    monkeypatch.setattr(Database, "rows", lambda self, query, values=None: asked.append(query) or rows(self, query, values))
    counts = []
    for more in (0, 12):
        run(url, lambda database, more=more: _many(database, more))
        asked.clear()
        class_ = run(url, lambda database: student_rows(database, "rigid-body"))
        counts.append(len(asked))
        assert len(class_) == 5 + more and class_stats.by_check(ASSIGNMENT, class_)[5].count == 3 + more
    assert counts == [3, 3]


async def _many(database, count):
    for k in range(count):
        await hand_in(database, f"more {k}", {"2-energy": "✓"})


def test_a_file_is_submitted_on_the_page_of_the_assignment(looks, url):
    page = looks("ben", OWN)[1]
    assert "<dd>1</dd>" in page and "best 0 of 2" in page
    assert looks("prof", "/assignments/rigid-body/rules", at=SETTINGS, most="2")[0] == 200
    status, page, _ = looks("ben", f"{OWN}/submissions", at=OWN, files={"file": ("mine.py", b"def euler_eqs(t, w, I): pass")})
    assert status == 200 and "mine.py" in page and "queued" in page
    assert "<dd>2 of 2</dd>" in looks("ben", OWN)[1]
    for name, content, code, words in (("mine.py", b"x", 403, "all 2 submissions"), ("mine.pdf", b"x", 422, ".ipynb")):
        status, page, headers = looks("ben", f"{OWN}/submissions", at=OWN, files={"file": (name, content)})
        assert status == code and words in page and headers["content-type"].startswith("text/html")
    assert looks("prof", "/assignments/rigid-body/rules", at=SETTINGS, most="")[0] == 200
