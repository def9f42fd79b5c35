"""Overrides: a reason always, one in force of each kind, nothing erased, every change in the audit trail."""

import asyncio

import pytest

from polhode.judging.verdict import RowsRight
from service.store.course import gradebook, grades, outcomes, overrides
from service.store.course.overrides import OverrideRejected, give, withdraw
from service.store.postgres.backup import check
from service.store.submissions import records
from service.store.submissions.past_submissions import past_submissions
from tests.support.database import run, sql
from tests.support.reports import outcome, report
from tests.support.submissions import graded, submitted


@pytest.fixture
def submission(database_url):
    return graded(database_url, "ann", "+--.")


def given(url, submission, check="c2", points=1, reason="the figure shows it", who="prof", **more):
    run(url, lambda d: give(d, submission, who, check=check, points=points, reason=reason, **more))


def points(url, submission):
    return run(url, lambda d: records.read(d, submission)).points


def known(url, submission):
    return run(url, lambda d: overrides.of_submission(d, submission))


def trail(url):
    return [
        (
            who,
            action,
            d["check"],
            d["before"],
            d["after"],
            [d["points"]["old"], d["points"]["new"]],
            d["reason"],
        )
        for who, action, d in sql(url, "SELECT actor, action, detail FROM audit ORDER BY id")
    ]


def test_points_for_a_check_and_for_all(database_url, submission):
    given(database_url, submission)
    assert points(database_url, submission) == 2
    given(database_url, submission, "c1", 0, "copied")
    assert points(database_url, submission) == 1
    given(database_url, submission, None, 3, "told in person")
    stored = run(database_url, lambda d: records.read(d, submission))
    assert stored.points == 3 and stored.report.score == 1  # what was measured stays
    whole = known(database_url, submission)[-1]
    assert run(database_url, lambda d: withdraw(d, submission, whole.id, "prof2"))
    assert points(database_url, submission) == 1
    assert trail(database_url) == [
        ("prof", "override", "c2", 0, 1, [1, 2], "the figure shows it"),
        ("prof", "override", "c1", 1, 0, [2, 1], "copied"),
        ("prof", "override", None, 1, 3, [1, 3], "told in person"),
        ("prof2", "override withdrawn", None, 3, None, [3, 1], "told in person"),
    ]
    assert run(database_url, lambda d: records.recent(d, 5))[0].points == 1
    assert run(database_url, lambda d: past_submissions(d, "ann", "rigid-body"))[0].points == 1


def test_a_check_of_four_points(database_url):
    partly = outcome("c1", "fail", points=4, partial=RowsRight(12, 16))
    sent = graded(database_url, "ann", exercises=report([partly, outcome("c2")]).exercises)
    assert points(database_url, sent) == 4
    assert not check(database_url)["reports whose outcomes do not add up to their score"]
    with pytest.raises(OverrideRejected, match="0 to 4"):
        given(database_url, sent, "c1", 5)
    for n, total in ((4, 5), (0, 1), (2, 3)):
        given(database_url, sent, "c1", n)
        assert points(database_url, sent) == total
    assert trail(database_url)[0][3:6] == (3, 4, [4, 5])
    (ann,) = run(database_url, lambda d: gradebook.students(d, "rigid-body"))
    assert run(database_url, lambda d: outcomes.by_student(d, [ann.grading])) == {
        ann.grading: {"c1": "fail*", "c2": "pass"}
    }
    (row,) = run(database_url, lambda d: grades.grades(d, "rigid-body"))
    assert (row.worth, row.earned, row.points) == ({"c1": 4, "c2": 1}, {"c1": 3, "c2": 1}, 3)


def test_an_override_gives_at_most_what_the_check_is_worth_after_a_regrade(database_url, submission):
    given(database_url, submission)
    sql(database_url, "UPDATE override SET points = 4")
    assert points(database_url, submission) == 2


def test_a_new_one_replaces_the_one_in_force_and_both_are_kept(database_url, submission):
    given(database_url, submission)
    given(database_url, submission, points=0, reason="no, it does not", who="prof2")
    old, new = known(database_url, submission)
    assert (old.in_force, old.withdrawn_by, new.in_force, new.points) == (False, "prof2", True, 0)
    assert points(database_url, submission) == 1 and trail(database_url)[1][3:5] == (1, 0)


@pytest.mark.parametrize(
    ("asked", "kind", "why"),
    [
        ({"points": 2}, "invalid-request", "0 to 1"),
        ({"check": None, "points": 4}, "invalid-request", "0 to 3"),
        ({"points": -1}, "invalid-request", "0 to 1"),
        ({"check": "c4"}, "invalid-request", "no counted check c4"),
        ({"check": "c9"}, "invalid-request", "no counted check c9"),
        ({"reason": ""}, "invalid-request", "give a reason"),
        ({"reason": "x" * 1001}, "invalid-request", "at most 1000"),
    ],
)
def test_what_cannot_be_given(database_url, submission, asked, kind, why):
    with pytest.raises(OverrideRejected, match=why) as error:
        given(database_url, submission, **asked)
    assert error.value.kind == kind and known(database_url, submission) == [] and trail(database_url) == []


def test_without_a_report_there_is_nothing_to_correct(database_url):
    id, _ = submitted(database_url)
    with pytest.raises(OverrideRejected) as error:
        given(database_url, id)
    assert error.value.kind == "not-ready"


def test_of_two_at_once_the_later_wins_and_both_are_told(database_url, submission):
    async def two(database):
        asked = [
            give(database, submission, f"p{k}", check="c2", points=k % 2, reason=f"reason {k}")
            for k in range(6)
        ]
        await asyncio.gather(*asked)

    run(database_url, two)
    all_of_them = known(database_url, submission)
    assert len(all_of_them) == 6 and sum(one.in_force for one in all_of_them) == 1
    last = all_of_them[-1]
    assert last.in_force and points(database_url, submission) == 1 + last.points
    entries = trail(database_url)
    assert [e[3] for e in entries[1:]] == [e[4] for e in entries[:-1]] and entries[-1][0] == last.by


def test_who_had_not_seen_the_last_change_is_told(database_url, submission):
    async def two(database):
        asked = [give(database, submission, who, check="c2", points=1, reason="mine", seen=0) for who in "ab"]
        return await asyncio.gather(*asked, return_exceptions=True)

    answers = run(database_url, two)
    (refused,) = [a for a in answers if a is not None]
    assert (
        isinstance(refused, OverrideRejected)
        and refused.kind == "changed-meanwhile"
        and "reload the page" in str(refused)
    )
    assert len(known(database_url, submission)) == 1
    given(database_url, submission, "c3", seen=overrides.revision(known(database_url, submission)))


def test_withdrawn_once(database_url, submission):
    given(database_url, submission)
    (one,) = known(database_url, submission)

    async def two(database):
        return await asyncio.gather(
            *(withdraw(database, submission, one.id, who) for who in "ab"), return_exceptions=True
        )

    answers = run(database_url, two)
    assert (
        sorted(type(a).__name__ for a in answers) == ["OverrideRejected", "bool"]
        and len(trail(database_url)) == 2
    )
    other = graded(database_url, "ben", "+")
    assert run(database_url, lambda d: withdraw(d, other, one.id, "x")) is False
