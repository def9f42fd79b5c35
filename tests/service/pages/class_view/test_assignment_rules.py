"""The pages of course, people and class, of a real server, as instructor, assistant and student."""

import json
import math
import re
import urllib.parse
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from types import SimpleNamespace

import pytest
from markupsafe import escape

from polhode.judging.outcome import Diagnosis, SweepResult, SweptPoint
from polhode.report.dataclass_json import document
from service.pages.class_view import charts, statistics
from service.store.course import outcomes
from service.store.course.gradebook import StudentRow, graded, students
from service.store.database import Database
from service.store.people import people
from service.store.submissions.artefacts import store_artefacts
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
        roster = [
            ("prof", "instructor"),
            ("helper", "assistant"),
            ("zoe", "student", "Zoe <b>Adams</b>"),
            ("gone", "former"),
        ]
        async with database.begin() as connection:
            await people.enroll(connection, roster)
        await hand_in(database, "ann", {"2-energy": ("✓", 1.5), "2-momentum": "✓"}, filename="<b>a.py")
        await hand_in(database, "ben", {"2-energy": ("✗", 1e-3), "2-momentum": "⏱"})
        await hand_in(database, "cleo", {"2-energy": ("✗", 0.1, SLIP), "2-momentum": ("!", None, RAISED)})
        await hand_in(database, "dan", None)

    run(url, fill)
    return url


NOBODY = StudentRow(
    "", "", "", "", 0, None, None, None, None, None, False, "", None, None, 0.0, None, None, False, None
)


def test_the_course_tells_who_has_submitted_and_what_waits(looks):
    status, page, headers = looks("prof", "/")
    assert status == 200 and "4 of 5 students submitted" in page and "1 being graded" in page
    assert "median 0 of 36 points" in tile(page, "Rigid-Body")
    assert 'class="pending"' in tile(page, "Rigid-Body") and "pending" not in tile(page, "Integrators")
    assert "default-src 'self'" in headers["content-security-policy"] and not re.search(
        r"\sstyle=|\son[a-z]+=", page
    )
    own = looks("ann", "/")[1]
    assert "2 of 36 points" in tile(own, "Rigid-Body") and "not submitted" in tile(own, "Integrators")
    assert "being graded" not in own and "4 of 5" not in own and own.count("/submissions/") == 1


def tile(page, title):
    (found,) = [
        one
        for one in re.findall(r'<li class="card tile">.*?</li>\n(?=<li|</ul>)', page, re.DOTALL)
        if title in one
    ]
    return found


def test_the_class_has_tabs_each_a_page_of_its_own(looks):
    links = re.findall(
        r'href="([^"]+)"', re.search(r'<nav class="tabs".*?</nav>', looks("helper", CLASS)[1], re.DOTALL)[0]
    )
    assert len(links) == 6
    for link in links:
        status, page, _ = looks("helper", link)
        assert status == 200 and page.count(f'<a href="{link}" aria-current="page">') == 1, link


def test_the_class_by_check(looks):
    page = looks("helper", f"{STUDENTS}?by=check")[1]
    assert (
        page.count(
            '<tr><th scope="row"><a href="/person?name=zoe">Zoe &lt;b&gt;Adams&lt;/b&gt;</a></th><td>–</td>'
        )
        == 1
    )
    rows = dict(
        re.findall(
            r'<tr><th scope="row"><a href="[^"]*">(\w+)</a></th><td><a[^>]*>(?:.*?)</td>(.*?)</tr>', page
        )
    )
    marks = {name: re.findall(r'<td class="(\w+)"[^>]*>(.)</td>', cells) for name, cells in rows.items()}
    assert marks["ann"] == [("pass", "✓"), ("pass", "✓")] and marks["ben"] == [
        ("fail", "✗"),
        ("timeout", "–"),
    ]
    assert marks["cleo"][1] == ("error", "–") and marks["dan"] == []
    assert page.count('<th scope="col"><a href') == len(ASSIGNMENT.checks())
    assert 'title="stopped by an error or an unusable value">–<' in page
    assert all(f">{escape(check.label)}</a></th>" in page for check in ASSIGNMENT.checks())
    page = looks("helper", f"{CLASS}/checks")[1]
    assert "1 of 3 (33%)" in page and "! small" in page and "<img src=x" not in page
    assert "<img src=x" not in looks("helper", CLASS)[1]


def test_the_class_by_exercise_has_a_cell_per_exercise(looks):
    page = looks("helper", STUDENTS)[1]
    assert page.count('class="exercise"') == len(ASSIGNMENT.exercises)
    ann, ben = (
        re.search(rf'<a href="/person\?name={name}">.*?</tr>', page, re.DOTALL)[0] for name in ("ann", "ben")
    )
    assert '<td class="pass">✓</td>' in ann and '<td class="fail">0/2</td>' in ben
    assert re.search(r'<td><time[^>]*title="[^"]*">now</time></td></tr>', ann), "the activity stands last"


def test_a_cell_of_an_exercise_has_the_first_state_that_is_not_passed():
    def cells(**states):
        return statistics.exercise_cells(states, [["a", "b", "c"], ["d"]])

    assert cells(a="pass", b="pass*") == ['<td class="pass">✓*</td>', "<td></td>"]
    assert cells(a="pass", b="timeout", c="fail")[0] == '<td class="fail">1/3</td>'
    assert cells(d="error*")[1].startswith('<td class="error" title="stopped by an error')
    assert statistics.passed([*cells(a="pass"), *cells(a="fail")]) == (1, 2)


def test_checks_are_grouped_by_cause(looks):
    page = looks("helper", f"{CLASS}/checks")[1]
    causes = page.partition("By cause")[2].partition("By check")[0]
    sentence = escape(SLIP.sentence)
    assert f">{sentence}</a></th><td>" in causes and "rotational energy conserved (torque-free)</a>" in causes


def test_students_are_sorted_and_those_who_gain_nothing_are_found(looks, url):
    def names(query):
        return re.findall(r'<tr><th scope="row"><a[^>]*>([^<]+)', looks("helper", STUDENTS + query)[1])

    assert (
        names("?sort=points")[0] == "ann"
        and names("?sort=worst")[-1] == "ann"
        and "ann" not in names("?sort=worst")[:2]
    )
    assert names("?sort=activity")[0] == "dan" and names("?sort=activity")[4].startswith("Zoe")
    assert (
        names("?show=no-gain") == [] and "No such students." in looks("helper", f"{STUDENTS}?show=no-gain")[1]
    )


def test_a_choice_of_the_students_page_keeps_the_others(looks):
    page = looks("helper", f"{STUDENTS}?by=check&sort=worst")[1]
    choices = re.findall(r'<a href="(\?by=[^"]*)"', page)
    assert len(choices) == 8 and "?by=exercise&amp;sort=worst&amp;show=all" in choices
    assert "?by=check&amp;sort=name&amp;show=all" in choices
    for choice in choices:
        assert looks("helper", STUDENTS + choice.replace("&amp;", "&"))[0] == 200, choice


def test_no_gain_needs_two_graded_submissions_and_points_to_gain():
    earned = {
        "same": [3, 3],
        "less": [3, 1],
        "more": [3, None, 4],
        "once": [3, None],
        "full": [9, 9],
        "late gain": [0, 0, 1],
        "": [],
    }
    assert [
        name for name, points in earned.items() if statistics.has_no_gain(replace(NOBODY, earned=points), 9)
    ] == [
        "same",
        "less",
    ]


def test_equal_names_are_told_apart_by_their_logins(looks, url):
    sql(url, "UPDATE person SET full_name = 'Ann Lee', sort_key = '' WHERE name IN ('ann', 'ben')")
    for page in (STUDENTS, f"{CLASS}/submissions"):
        shown = re.findall(
            r'<th scope="row"><a[^>]*>([^<]+)</a>(?: <span class="quiet">(\w+)</span>)?</th>',
            looks("helper", page)[1],
        )
        assert shown[:2] == [("Ann Lee", "ann"), ("Ann Lee", "ben")] and ("cleo", "") in shown, page
    sql(url, "UPDATE person SET full_name = '', sort_key = name WHERE name IN ('ann', 'ben')")


def test_the_overview_draws_points_and_progress(looks):
    page = looks("helper", CLASS)[1]
    charts_ = re.findall(r'<svg class="chart".*?</svg>', page, re.DOTALL)
    assert [re.search('aria-label="([^"]+)"', one)[1].split(":")[0].split(" from")[0] for one in charts_] == [
        "Students by points", "4 of 5 students submitted"]  # fmt: skip
    bars = re.findall(r'class="middle">(\d+)</text>', charts_[0])
    assert bars == ["3"] and charts_[0].count("<rect") == 1, "0 to 3 of 36 points are one bin"
    assert (
        "median 0 of 36, from 0 to 2" in charts_[0]
        and ">4 submitted<" in charts_[1]
        and ">0 full marks<" in charts_[1]
    )


@pytest.mark.parametrize("most", [1, 9, 36, 400])
def test_every_student_is_in_one_bar_of_the_distribution(most):
    students = [replace(NOBODY, points=points, final=points) for points in (0, 0.5, most / 2, most, most + 1)]
    drawn = str(charts.distribution([*students, NOBODY], most))
    assert (
        sum(map(int, re.findall(r'class="middle">(\d+)</text>', drawn))) == 5
        and drawn.count("<rect") <= charts.MOST_BINS + 1
    )
    assert charts.distribution([NOBODY], most) is None
    assert min(map(float, re.findall(r'y="([\d.]+)" class="middle">', drawn))) > 10 + 12, (
        "below the title of the axis"
    )
    edges = [int(text) for text in re.findall(r'class="middle quiet">(\d+)</text>', drawn)]
    assert edges == list(range(0, edges[-1] + 1, edges[1])) and len(edges) <= charts.MOST_BINS + 2
    assert edges[-1] > most + 1 if edges[1] > 1 else edges[-1] == most + 1, (
        "both edges of a bin, or the points of each"
    )


def test_nothing_runs_out_of_the_progress_chart():
    first = datetime(2026, 1, 1, tzinfo=UTC)
    assert charts.progress([NOBODY], 9, None) is None
    ann = replace(NOBODY, sent_at=[first, first + timedelta(hours=2)], earned=[3, 9])
    class_ = [ann, replace(NOBODY, sent_at=[first], earned=[None]), NOBODY]
    for due in (
        None,
        first - timedelta(days=1),
        first + timedelta(hours=1),
        datetime(2999, 1, 1, tzinfo=UTC),
    ):
        drawn = str(charts.progress(class_, 9, due))
        edges = [
            float(x)
            for x in re.findall(r'[MH ](?:x\d?=")?(\d+\.?\d*)', " ".join(re.findall(r'd="[^"]+"', drawn)))
        ]
        assert ">2 submitted<" in drawn and ">1 full marks<" in drawn and max(edges) <= charts.WIDE


def test_causes_by_number_of_students_lead_to_their_submissions(looks):
    page = looks("prof", CLASS)[1]
    link, count = re.search(r'href="(/assignments/[^"]*cause=[^"]*)">(\d+) student', page).groups()
    assert count == "2" and SLIP.sentence in page
    chosen = looks("prof", link.replace("&amp;", "&"))[1]
    assert (
        "<h2>2 of 5 students</h2>" in chosen
        and "ben" in chosen
        and "cleo" in chosen
        and ">ann<" not in chosen
    )
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
    assert f"{300 / (3 + others):.3g} % of the grade" in tile(page, "Rigid-Body") and page.index(
        "Rigid-Body"
    ) < page.index("Integrators")
    extend = "/assignments/rigid-body/extensions"
    assert (
        "ill &lt;b&gt;"
        in looks("prof", extend, at=SETTINGS, name="zoe", due="2099-02-01T12:00", reason="ill <b>")[1]
    )
    for fields in (
        {"name": "nobody", "due": "2099-02-01T12:00", "reason": "x"},
        {"name": "zoe", "due": "soon", "reason": "x"},
        {"name": "zoe", "due": "2099-02-01T12:00"},
        {"name": "ben"},
        {"name": "zoe", "due": "2020-02-01T12:00", "reason": "x"},
    ):
        assert looks("prof", extend, at=SETTINGS, **fields)[0] == 422, fields
    assert looks("prof", "/assignments/rigid-body/rules", at=SETTINGS, due="", grace="-1")[0] == 422
    assert sql(url, "SELECT p.name, e.reason FROM extension e JOIN person p ON p.id = person_id") == [
        ("zoe", "ill <b>")
    ]
    assert (
        "2099-02-01 12:00" in tile(looks("zoe", "/")[1], "Rigid-Body")
        and "with your extension" in looks("zoe", "/")[1]
    )
    assert "2099-02-01 12:00" in looks("zoe", OWN)[1] and "with your extension" in looks("zoe", OWN)[1]
    assert "with your extension" not in looks("ann", OWN)[1]
    page = looks("prof", extend, at=SETTINGS, name="zoe  <B>Adams</b>", due="")[1]
    undo = dict(
        re.findall(r'name="(name|due|reason)" value="([^"]*)"', page[page.index('class="notice"') :])[:3]
    )
    assert (
        undo == {"name": "zoe", "due": "2099-02-01T12:00:00+00:00", "reason": "ill &lt;b&gt;"}
        and ">Undo<" in page
    )
    assert sql(url, "SELECT count(*) FROM extension") == [(0,)]
    assert looks("prof", extend, at=SETTINGS, **undo)[0] == 200 and sql(
        url, "SELECT count(*) FROM extension"
    ) == [(1,)]
    assert ">Undo<" not in looks("prof", f"{SETTINGS}?removed=zoe")[1]
    assert looks("prof", extend, at=SETTINGS, name="zoe", due="")[0] == 200
    assert sql(url, "SELECT count(*) FROM extension") == [(0,)]
    assert looks("prof", "/assignments/rigid-body/rules", at=SETTINGS, due="", grace="0", most="")[0] == 200


@pytest.mark.slow
def test_the_class_is_swept_once_and_drawn(looks, url):
    """Jobs for who has not been swept, however often it is asked for; the chart is of who has."""
    asked = "SELECT count(*) FROM procrastinate_jobs WHERE task_name = 'sweep'"
    assert (
        looks("helper", f"{CLASS}/sweep.svg")[0] == 404
        and "3 graded submissions have" in looks("helper", CLASS)[1]
    )
    assert 'data-saved="Measurement queued.' in looks("helper", CLASS)[1]
    swept = SweepResult(
        "exercise 2",
        [SweptPoint("DOP853", 1e-11, 1000, 1e-10, 0.01)],
        "fine",
    )
    ann = sql(
        url,
        "SELECT a.id FROM grading a JOIN submission s ON s.id = submission_id WHERE s.filename = '<b>a.py'",
    )[0][0]
    run(
        url,
        lambda database: store_artefacts(database, ann, {"sweep.json": json.dumps(document(swept)).encode()}),
    )
    for _ in range(2):
        assert looks("helper", f"{CLASS}/sweep", at=CLASS)[0] == 200 and sql(url, asked)[0][0] == 2
    page, (status, chart, headers) = looks("helper", CLASS)[1], looks("helper", f"{CLASS}/sweep.svg")
    assert "1 functions of the class" in page and "2 graded submissions have" in page
    assert status == 200 and headers["content-type"].startswith("image/svg+xml") and ">DOP853<" in chart


def test_who_may_not_and_forms_without_their_token(looks, server):
    for path in (
        CLASS,
        STUDENTS,
        f"{CLASS}/checks",
        SETTINGS,
        f"{CLASS}/submissions",
        f"{CLASS}/sweep.svg",
        "/people",
    ):
        status, page, headers = looks("ann", path)
        assert status == 403 and "staff" in page and headers["content-type"].startswith("text/html")
    for path in ("/assignments/rigid-body/rules", "/assignments/rigid-body/extensions", "/people"):
        assert looks("helper", path, at=f"{OWN}/regrades", name="zoe")[0] == 403
        status, page, _ = looks("prof", path, at=SETTINGS, csrf="0" * 64, name="zoe")
        assert status == 403 and "reload the page" in page


def test_a_page_asks_as_often_however_large_the_class_is(url, monkeypatch):
    """No query per row: counted at the gradebook, whose rows make the page."""
    asked = []
    rows = Database.rows
    monkeypatch.setattr(
        Database, "rows", lambda self, query, values=None: asked.append(query) or rows(self, query, values)
    )

    async def read(database):
        class_ = await students(database, "rigid-body")
        return class_, statistics.by_check(ASSIGNMENT, await outcomes.by_check(database, graded(class_)))

    for more in (0, 12):
        run(url, lambda database, more=more: _many(database, more))
        asked.clear()
        class_, checks = run(url, read)
        assert len(class_) == 5 + more and checks[5].count == 3 + more and len(asked) == 2


async def _many(database, count):
    for k in range(count):
        await hand_in(database, f"more {k}", {"2-energy": "✓"})


def test_full_marks_need_no_points_of_optional_functions(looks, url):
    every = {check.id: "✓" for exercise in ASSIGNMENT.exercises for check in exercise.checks}
    for points, wrong in ((35, 7), (40, 2)):
        marks = every | dict.fromkeys([*every][:wrong], "✗")
        run(url, lambda database, marks=marks: hand_in(database, "zoe", marks))
        shown = tile(looks("zoe", "/")[1], "Rigid-Body")
        assert f"{points} of 36 points" in shown and ("✓ full marks" in shown) == (points >= 36)


def test_a_file_is_submitted_on_the_page_of_the_assignment(looks, url):
    page = looks("ben", OWN)[1]
    assert "<dd>1</dd>" in page and "best 0, last 0, of 36" in page
    assert looks("prof", "/assignments/rigid-body/rules", at=SETTINGS, most="2")[0] == 200
    status, page, _ = looks(
        "ben", f"{OWN}/submissions", at=OWN, files={"file": ("mine.py", b"def euler_eqs(t, w, I): pass")}
    )
    assert status == 200 and "mine.py" in page and "queued" in page
    assert "<dd>2 of 2</dd>" in looks("ben", OWN)[1]
    for name, content, code, words in (
        ("mine.py", b"x", 403, "all 2 submissions"),
        ("mine.pdf", b"x", 422, ".ipynb"),
    ):
        status, page, headers = looks("ben", f"{OWN}/submissions", at=OWN, files={"file": (name, content)})
        assert status == code and headers["content-type"].startswith("text/html")
        assert re.search(
            rf'id="refused"[^>]*>[^<]*{re.escape(words)}[^<]*; choose the file again</span>', page
        )
    assert looks("prof", "/assignments/rigid-body/rules", at=SETTINGS, most="")[0] == 200


@pytest.mark.parametrize(
    ("margins", "exact", "smallest", "median"),
    [
        ([2.0, 8.0, 1e-13], 0, 2.0, 2.0),
        ([2.0, 1e-13], 2, 2.0, math.inf),
        ([2.0, 1e-13], 1, 2.0, 2.0),
        ([1e-13], 2, None, None),
        ([1e-13, 1e-3, 1e-1], 0, None, 1e-3),
        (None, 0, None, None),
    ],
)
def test_a_check_passed_without_deviation_counts_in_the_median_margin(margins, exact, smallest, median):
    check = ASSIGNMENT.exercises[0].checks[0]
    found = SimpleNamespace(states="pass fail", margins=margins, causes=None, exact=exact, smallest=smallest)
    assert statistics.by_check(ASSIGNMENT, {check.id: found})[0].median_margin == median


def test_margins_are_counted_by_decade_and_the_outermost_bins_have_all_beyond():
    check = ASSIGNMENT.exercises[0].checks[0]
    margins = [1e-99, 1e-4, 0.5, 1.0, 9.99, 10.0, 1e12, 1e99]
    found = SimpleNamespace(states="pass", margins=margins, causes=None, exact=0, smallest=1.0)
    bins = dict(
        zip(statistics.DECADES, statistics.by_check(ASSIGNMENT, {check.id: found})[0].bins, strict=True)
    )
    assert {decade: count for decade, count in bins.items() if count} == {-4: 2, -1: 1, 0: 2, 1: 1, 12: 2}
