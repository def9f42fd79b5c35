"""Pages of regrades, points by hand and the audit trail, as three roles see them; nothing is graded here but
by the tests.
"""

import re

import pytest

from polhode.judging.verdict import RowsRight
from service.store.submissions import records
from tests.support.database import run, sql
from tests.support.reports import outcome, report
from tests.support.submissions import finish, grade_open, graded, open_gradings, submitted
from tests.support.visitor import Visitor, enter

REGRADES = "/assignments/rigid-body/regrades"


@pytest.fixture(scope="module")
def people(server, url):
    enter(url, prof="instructor", prof2="instructor", tutor="assistant", ann="student", ben="student")
    return {name: Visitor(server, url, name) for name in ("prof", "prof2", "tutor", "ann", "ben")}


@pytest.fixture(autouse=True)
def emptied(url):
    yield
    sql(
        url,
        "TRUNCATE submission, grading, result, outcome, run, override, regrade, audit, procrastinate_jobs"
        " CASCADE",
    )


def row_of(page, person):
    """What the table says of a person, without markup."""
    (found,) = [row for row in re.findall(r"<tr>(.*?)</tr>", page, re.DOTALL) if f">{person}</a>" in row]
    return " ".join(re.sub(r"<[^>]+>", " ", found).split())


def test_a_preview_tells_who_gains_and_who_loses_and_only_an_instructor_applies(server, url, people):
    prof, tutor, ann = people["prof"], people["tutor"], people["ann"]
    hers, his = graded(url, "ann", "+--"), graded(url, "ben", "+++")
    sql(url, "UPDATE person SET full_name = 'Ben Ek' WHERE name = 'ben'")
    status, where = tutor.send(REGRADES, REGRADES, which="all")
    assert (
        status == 303
        and "0 of 2 graded" in tutor.open(where)[1]
        and 'data-live="' + where in tutor.open(where)[1]
    )
    assert prof.send(f"{where}/apply", where) == (
        409,
        "the regrade cannot be applied yet: 2 of its submissions have not been graded yet",
    )
    grade_open(url, {hers: "++-"})
    assert "1 of 2 graded" in prof.open(where)[1] and "Apply" not in prof.open(where)[1]
    grade_open(url, {his: "-+?"})
    page = prof.open(where)[1]
    assert (
        "2 of 2 graded" in page and "Version 1 → 2" in page and "1 gain, 1 lose, 0 keep their points" in page
    )
    assert row_of(page, "ann") == "ann 1 → 2 ✗ → ✓ (failed, now passed) c2"
    assert row_of(page, "Ben Ek").startswith(
        "Ben Ek ben 3 → 1 ✓ → ✗ (passed, now failed) c1 ✓ → – (passed, now not measured) c3"
    )
    assert ann.open(where)[0] == 403 and ann.json(f"/v1/submissions/{hers}")["report"]["score"] == 1
    assert tutor.send(f"{where}/apply", where)[0] == ann.send(f"{where}/apply", "/")[0] == 403
    assert prof.send(f"{where}/apply", where) == (303, where)
    assert ann.json(f"/v1/submissions/{hers}")["report"]["score"] == 2
    page = prof.open(where)[1]
    assert (
        "applied by prof" in page
        and "data-live" not in page
        and "1 gain, 1 lose" in page
        and "csrf" not in page
    )
    assert people["prof2"].send(f"{where}/apply", REGRADES) == (
        409,
        "prof has already applied this regrade: reload the page",
    )
    assert "✓ applied by prof" in tutor.open(REGRADES)[1]


def test_one_of_them_and_a_checks_victims(server, url, people):
    prof, tutor = people["prof"], people["tutor"]
    hers, his = graded(url, "ann", "+-"), graded(url, "ben", "++")
    assert "Regrade (preview)" in tutor.open(f"/submissions/{hers}")[1]
    assert "Regrade (preview)" not in people["ann"].open(f"/submissions/{hers}")[1]
    status, where = tutor.send(REGRADES, f"/submissions/{hers}", which=hers)
    assert (
        status == 303
        and [s for s, _ in open_gradings(url)] == [hers]
        and "one submission of ann" in tutor.open(where)[1]
    )
    assert people["ann"].send(f"{where}/drop", "/")[0] == 403
    assert tutor.send(f"{where}/drop", where) == (303, where) and open_gradings(url) == []  # who asked may
    _, where = prof.send(REGRADES, REGRADES, which="all")
    assert tutor.send(f"{where}/drop", where)[0] == 403 and prof.send(f"{where}/drop", where)[0] == 303
    for asked, status, why in (
        ({"which": "check", "check": "nope"}, 422, "no check nope"),
        ({"which": ""}, 422, "select submissions"),
        ({"which": "x"}, 404, "no entry with the id x"),
        ({"which": "00000000-0000-0000-0000-000000000000"}, 404, "has no submission"),
        ({"which": "check", "check": "euler.direction"}, 409, "nothing to regrade"),
    ):
        labels = re.findall(r'<option value="([^"]+)"', prof.open(REGRADES)[1])
        asked = {k: labels[0] if v == "euler.direction" else v for k, v in asked.items()}
        answer = prof.send(REGRADES, REGRADES, **asked)
        assert answer[0] == status and why in answer[1], answer
    assert (
        his
        and prof.open("/regrades/x")[0]
        == prof.open("/regrades/00000000-0000-0000-0000-000000000000")[0]
        == 404
    )
    assert prof.open("/assignments/nope/regrades")[0] == 404


def test_points_by_hand_are_told_to_the_student_with_name_and_reason(server, url, people):
    prof, tutor, ann = people["prof"], people["tutor"], people["ann"]
    id = graded(url, "ann", "+--")
    own, give = f"/submissions/{id}", f"/submissions/{id}/overrides"
    for other in (tutor, ann):
        assert other.send(give, own, check="c2", points="1", reason="please")[0] == 403
        assert "Override score" not in other.open(own)[1]
    reason = "Her figure shows it <b>&</b> more.\nSee you."
    assert prof.send(give, own, check="c2", points="1", reason=reason, seen="0") == (303, f"{own}#points")
    page = ann.open(own)[1]
    assert (
        "2 of 36 (graded 1)" in page
        and "Her figure shows it &lt;b&gt;&amp;&lt;/b&gt; more." in page
        and "prof " in page
    )
    told = ann.json(f"/v1/submissions/{id}")
    assert told["points"] == 2 and told["report"]["score"] == 1
    (one,) = told["overrides"]
    assert (
        (one["check"], one["points"], one["by"]) == ("c2", 1, "prof")
        and one["at"]
        and one["reason"].endswith("See you.")
    )
    assert "2 of 36 (graded 1)" in ann.open("/assignments/rigid-body")[1]
    listed = ann.json("/v1/assignments/rigid-body/submissions")["submissions"][0]
    assert (listed["points"], listed["score"]) == (2, 1)
    stale = people["prof2"].send(give, own, check="c2", points="0", reason="no", seen="0")
    assert stale[0] == 409 and "reload the page" in stale[1]
    (override,) = sql(url, "SELECT id FROM override")[0]
    withdraw = f"{give}/{override}/withdraw"
    assert tutor.send(withdraw, own)[0] == ann.send(withdraw, own)[0] == 403
    assert people["prof2"].send(withdraw, own)[0] == 303 and people["prof2"].send(withdraw, own)[0] == 409
    assert "overrides" not in ann.json(f"/v1/submissions/{id}") and "withdrawn by prof2" in ann.open(own)[1]
    trail = tutor.open(f"/audit?subject={id}")[1]
    assert (
        "withdrew an override of" in trail
        and "points: <s>1</s> → 2" in trail
        and "points: <s>2</s> → 1" in trail
        and "&lt;b&gt;" in trail
    )


def test_an_override_may_be_a_fraction_and_the_whole_of_exercises_left_out(server, url, people):
    id = graded(url, "ann", "+--", total=36)
    own, prof = f"/submissions/{id}", people["prof"]
    for check, points, stored in (
        ("c2", "0.25", 1.25),
        ("c3", "0,5", 1.75),
        ("c2", "1", 2.5),
        ("", "36", 36),
    ):
        assert prof.send(f"{own}/overrides", own, check=check, points=points, reason="by mouth")[0] == 303
        assert run(url, lambda d: records.read(d, id)).points == stored
        shown = people["ann"].open(own)[1]
        assert f"{stored} of 36" in shown and re.search(r"<td>\d of 36 points</td>", shown), (
            "the gradings have the same maximum"
        )
    assert prof.send(f"{own}/overrides", own, check="", points="37", reason="by mouth")[0] == 422


def test_pages_show_what_a_check_of_several_points_is_worth_and_earned(server, url, people):
    partly = outcome("c1", "fail", points=4, partial=RowsRight(12, 16))
    made = report([partly, outcome("c2")]).exercises
    id = graded(url, "ann", exercises=made, total=36, max_points=36, bonus_points=6)
    own, prof = f"/submissions/{id}", people["prof"]
    page = prof.open(own)[1]
    assert (
        "12 of 16 inputs are right: 3 of 4 points" in page
        and '<span class="badge">3 of 4 points</span>' in page
    )
    assert "<b>4</b> of 36, +0 of 6 bonus points" in page and "<td>4 of 36 points, version 1</td>" in page
    assert '<optgroup label="1 Title 1"><option value="c1" data-max="4">c1 (c1, 4 points)</option>' in page
    assert '<option value="c2" data-max="1">c2 (c2, 1 point)</option>' in page
    assert prof.send(f"{own}/overrides", own, check="c1", points="4", reason="the rest is right too") == (
        303,
        f"{own}#points",
    )
    assert "5 of 36 (graded 4)" in people["ann"].open(own)[1]
    told = people["ann"].json(f"/v1/submissions/{id}")
    listed = [(o["points"], o["earned"]) for e in told["report"]["exercises"] for o in e["outcomes"]]
    assert (listed, told["points"], told["report"]["score"]) == ([(4, 3), (1, 1)], 5, 4)


def test_a_regrade_that_changes_partial_credit_only_names_the_check(server, url, people):
    def graded_with(right):
        return report([outcome("c1", "fail", points=4, partial=RowsRight(right, 16))]).exercises

    id = graded(url, "ann", exercises=graded_with(12))
    _, where = people["prof"].send(REGRADES, REGRADES, which=id)
    ((_, grading),) = open_gradings(url)
    finish(url, grading, version="2", exercises=graded_with(8))
    assert "✗ → ✗, 3 → 2 points" in people["prof"].open(where)[1]


@pytest.mark.parametrize(
    ("fields", "status", "why"),
    [
        ({"points": "2", "check": "c1"}, 422, "the points of the check c1 must be from 0 to 1"),
        ({"points": "4", "check": ""}, 422, "the points of the submission must be from 0 to 3"),
        ({"points": "-1"}, 422, "at most two decimals"),
        ({"points": "½"}, 422, "at most two decimals"),
        ({"points": "0.125"}, 422, "at most two decimals"),
        ({"points": "1.01", "check": "c1"}, 422, "must be from 0 to 1"),
        ({"points": "1", "reason": " "}, 422, "give a reason"),
        ({"points": "1", "reason": "x" * 1001}, 422, "at most 1000"),
        ({"points": "1", "check": "c9"}, 422, "no counted check c9"),
        ({"points": "1", "check": "c1", "reason": "a\x00b"}, 303, ""),
    ],
)
def test_points_that_cannot_be_given(server, url, people, fields, status, why):
    id = graded(url, "ann", "+--")
    asked = {"check": "", "reason": "because"} | fields
    answer = people["prof"].send(f"/submissions/{id}/overrides", f"/submissions/{id}", **asked)
    assert answer[0] == status and why in answer[1], answer
    assert run(url, lambda d: records.read(d, id)).points == 1


def test_no_report_no_points_and_no_submission_no_page(server, url, people):
    id, _ = submitted(url)
    graded(url, "ben", "+")
    other = sql(url, "SELECT id FROM submission WHERE id <> %s", id)[0][0]
    answer = people["prof"].send(
        f"/submissions/{id}/overrides", f"/submissions/{other}", points="1", reason="x"
    )
    assert answer == (409, "the submission has no report yet: override its points once it is graded")
    assert (
        people["prof"].send("/submissions/x/overrides", f"/submissions/{other}", points="1", reason="x")[0]
        == 404
    )


def test_what_waits_and_is_held_is_shown_in_the_queue(server, url, people):
    mine = graded(url, "ann", "+")
    people["prof"].send(REGRADES, REGRADES, which="all")
    for _ in range(2):
        submitted(url, "ben")
    page = people["tutor"].open("/queue")[1]
    assert "Waiting: 3" in page and "2 interactive, 1 regrade" in page and "preview only" in page
    assert re.search(rf'<td>3</td>\s*<th scope="row"><a href="/submissions/{mine}">ann</a>', page)
    assert "No worker is running" in page
