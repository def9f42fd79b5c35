"""Regrades: preview until they are applied, all at once, by one; what was shown stays, and nothing preview
counts anywhere.
"""

import asyncio

import pytest

from service.store.course import overrides, regrades
from service.store.course.regrades import BEST, EVERY, NothingToGrade, RegradeClosed, RegradeIncomplete
from service.store.queue import workers
from service.store.queue.cancelling import cancel
from service.store.queue.overview import regrade, snapshot
from service.store.submissions import records
from service.store.submissions.accepting import accept
from service.store.submissions.past_submissions import past_submissions
from tests.support.database import new, run, sql
from tests.support.submissions import claim, finish, grade_open, graded, open_gradings, submitted


def begin(url, which=BEST, check=None):
    return run(
        url, lambda d: regrades.create(d, "rigid-body", which, "tutor", check=check, description="a test")
    )


def points(url, submission):
    return run(url, lambda d: records.read(d, submission)).points


def read(url, told, id):
    return run(url, lambda d: told(d, id))


def test_nothing_shown_changes_until_it_is_applied(database_url):
    ann, ben, cleo = (
        graded(database_url, p, told) for p, told in (("ann", "+-"), ("ben", "++"), ("cleo", "--"))
    )
    id = begin(database_url)
    assert (
        read(database_url, regrades.find, id).total == 3
        and read(database_url, regrades.find, id).finished == 0
    )
    assert len({submission for submission, _ in open_gradings(database_url)}) == 3
    assert sql(database_url, "SELECT DISTINCT seed, kind, preview FROM grading WHERE number = 2") == [
        (7, "regrade", True)
    ]
    with pytest.raises(RegradeIncomplete, match="3 of its"):
        run(database_url, lambda d: regrades.apply(d, id, "prof"))
    grade_open(database_url, {ann: "++", ben: "+-", cleo: "--"})
    assert [points(database_url, one) for one in (ann, ben, cleo)] == [1, 2, 0]
    told = {
        row.person: (row.was_points, row.points, row.was_version, row.version)
        for row in read(database_url, regrades.score_changes, id)
    }
    assert told == {"ann": (1, 2, "1", "2"), "ben": (2, 1, "1", "2"), "cleo": (0, 0, "1", "2")}
    flips = {(row.check_id, row.was, row.now) for row in read(database_url, regrades.check_changes, id)}
    assert flips == {("c2", "fail", "pass"), ("c2", "pass", "fail")}
    assert run(database_url, lambda d: regrades.apply(d, id, "prof")) == 3
    assert [points(database_url, one) for one in (ann, ben, cleo)] == [2, 1, 0]
    assert told == {
        r.person: (r.was_points, r.points, r.was_version, r.version)
        for r in read(database_url, regrades.score_changes, id)
    }
    assert flips == {
        (row.check_id, row.was, row.now) for row in read(database_url, regrades.check_changes, id)
    }
    applied = read(database_url, regrades.find, id)
    assert (applied.decided, applied.decided_by) == ("applied", "prof") and applied.decided_at is not None
    assert sql(database_url, "SELECT count(*) FROM grading") == [(6,)]  # the first ones are still there
    assert sql(database_url, "SELECT actor, action FROM audit ORDER BY id") == [
        ("tutor", "regrade begun"),
        ("prof", "regrade applied"),
    ]


def test_what_is_held_counts_nowhere(database_url):
    id, grading = submitted(database_url)
    run(database_url, lambda d: cancel(d, grading, "prof"))
    begin(database_url, id)
    ((_, preview),) = open_gradings(database_url)
    assert run(database_url, lambda d: records.read(d, id)).status == "faulted"
    assert [f.submission for f in run(database_url, snapshot).faults] == [id]
    sql(database_url, "UPDATE assignment SET submission_limit = 1")
    one = new()
    assert run(
        database_url, lambda d: accept(d, one)
    ).fresh  # the fault, preview grading or not, used nothing up
    finish(database_url, preview, "++")
    assert run(database_url, lambda d: records.read(d, id)).status == "faulted"
    assert run(database_url, lambda d: records.state(d, id)).number == 1
    assert [f.submission for f in run(database_url, snapshot).faults] == [id]
    assert {p.id: p.score for p in run(database_url, lambda d: past_submissions(d, "ann", "rigid-body"))} == {
        id: None,
        one.id: None,
    }
    # the last one that counts is the fault
    assert run(database_url, lambda d: regrade(d, "faults", "x")) == 1


def test_a_held_grading_that_is_under_way_does_not_stop_an_immediate_regrade(database_url):
    id = graded(database_url, "ann", "+-")
    made = begin(database_url, id)
    ((_, preview),) = open_gradings(database_url)
    assert run(database_url, lambda d: regrade(d, [id], "x")) == 1
    later = next(grading for _, grading in open_gradings(database_url) if grading != preview)
    finish(database_url, later, "--", version="3")
    finish(database_url, preview, "++")
    assert points(database_url, id) == 0
    (row,) = read(database_url, regrades.score_changes, made)
    assert row.overtaken and (row.was_points, row.points) == (1, 2)
    assert run(database_url, lambda d: regrades.apply(d, made, "prof")) == 0  # what was graded later stays
    assert points(database_url, id) == 0


def test_which_ones(database_url):
    first, second = graded(database_url, "ann", "+--"), graded(database_url, "ann", "++-")
    same, newest = graded(database_url, "ben", "-++"), graded(database_url, "ben", "+-+")
    other = graded(database_url, "cleo", ".+?")
    graded(database_url, "dora", "+")  # has no c2
    waiting, _ = submitted(database_url, "eve")

    def meant(which, check=None):
        run(database_url, lambda d: workers.recover(d))
        id = begin(database_url, which, check)
        ids = {row.submission for row in read(database_url, regrades.score_changes, id)}
        run(database_url, lambda d: regrades.drop(d, id, "tutor"))
        return ids

    assert meant(first) == {first}
    best = meant(BEST)
    assert {second, newest, other} < best and not {first, same, waiting} & best and len(best) == 4
    assert len(meant(EVERY)) == 6 and waiting not in meant(EVERY)
    assert meant(BEST, "c2") == {newest} and meant(BEST, "c3") == {second, other}
    assert meant(EVERY, "c1") == {same}  # what does not count has no victims
    for nobody in (("c9", BEST), (None, waiting)):
        with pytest.raises(NothingToGrade):
            begin(database_url, nobody[1], nobody[0])
    assert sql(database_url, "SELECT count(*) FROM regrade WHERE decided IS NULL") == [(0,)]


def test_the_best_is_the_one_with_the_most_points_given_by_hand_too(database_url):
    first, second = graded(database_url, "ann", "+--"), graded(database_url, "ann", "++-")
    run(database_url, lambda d: overrides.give(d, first, "prof", check=None, points=3, reason="by hand"))
    id = begin(database_url)
    (row,) = read(database_url, regrades.score_changes, id)
    assert row.submission == first and row.overridden and second != first
    grade_open(database_url, {first: "---"})
    (row,) = read(database_url, regrades.score_changes, id)
    assert (row.was_points, row.points, row.was_score, row.score) == (3, 3, 1, 0)  # it stays in force


def test_an_override_of_a_check_stays_in_force_and_is_counted_once(database_url):
    id = graded(database_url, "ann", "+-")
    run(database_url, lambda d: overrides.give(d, id, "prof", check="c2", points=1, reason="by hand"))
    made = begin(database_url)
    grade_open(database_url, {id: "-+"})
    (row,) = read(database_url, regrades.score_changes, made)
    assert (row.was_points, row.points) == (2, 1)
    run(database_url, lambda d: regrades.apply(d, made, "prof"))
    assert points(database_url, id) == 1


def test_a_fault_stays_held_and_the_others_are_applied(database_url):
    ann, ben = graded(database_url, "ann", "-"), graded(database_url, "ben", "-")
    id = begin(database_url)
    grade_open(database_url, {ann: "+"})
    sql(
        database_url,
        "INSERT INTO result (grading_id, fault) SELECT id, 'ours' FROM grading WHERE submission_id = %s AND"
        " preview",
        ben,
    )
    assert run(database_url, lambda d: regrades.apply(d, id, "prof")) == 1
    assert (points(database_url, ann), points(database_url, ben)) == (1, 0)
    assert run(database_url, lambda d: records.read(d, ben)).status == "graded"
    assert sql(database_url, "SELECT submission_id FROM grading WHERE preview") == [(ben,)]


@pytest.mark.slow
def test_applied_twice_or_dropped_meanwhile_is_decided_once(database_url):
    ann = graded(database_url, "ann", "-")
    for k in range(4):
        id = begin(database_url)
        grade_open(database_url, {ann: "+" * (k % 2 + 1)})

        async def at_once(database, id=id):
            asked = [
                regrades.apply(database, id, "a"),
                regrades.apply(database, id, "b"),
                regrades.drop(database, id, "c"),
            ]
            return await asyncio.gather(*asked, return_exceptions=True)

        answers = run(database_url, at_once)
        assert sum(isinstance(a, RegradeClosed) for a in answers) == 2, answers
        decided = read(database_url, regrades.find, id)
        sentence = f"{decided.decided_by} has already {decided.decided} this regrade: reload the page"
        assert [e for e in map(str, answers) if "already" in e] == [sentence] * 2
        preview = sql(database_url, "SELECT count(*) FROM grading WHERE preview AND regrade_id = %s", id)
        assert preview == [(int(decided.decided == "dropped"),)]
    assert sql(
        database_url, "SELECT count(*) FROM audit WHERE action IN ('regrade applied', 'regrade dropped')"
    ) == [(4,)]


def test_dropped_it_grades_no_more_and_stays_held(database_url):
    ann, ben = graded(database_url, "ann", "-"), graded(database_url, "ben", "-")
    id = begin(database_url)
    grade_open(database_url, {ann: "+"})
    ((_, grading),) = open_gradings(database_url)
    claimed = claim(database_url, grading)
    assert run(database_url, lambda d: regrades.drop(d, id, "tutor")) == 1
    assert sql(database_url, "SELECT end_reason FROM run WHERE id = %s", claimed.run) == [("cancelled",)]
    assert (
        sql(database_url, "SELECT count(*) FROM procrastinate_jobs") == [(0,)]
        and open_gradings(database_url) == []
    )
    assert (points(database_url, ann), points(database_url, ben)) == (0, 0)
    sql(database_url, "UPDATE grading SET requested_at = requested_at - interval '1 minute'")
    assert run(database_url, workers.sweep) == []
    assert run(database_url, lambda d: regrade(d, "all", "x")) == 2


@pytest.mark.slow
def test_begun_while_students_submit(database_url):
    for name in ("ann", "ben", "cleo"):
        graded(database_url, name, "+")

    async def at_once(database):
        begun = regrades.create(database, "rigid-body", BEST, "tutor", description="a test")
        sent = [accept(database, new(name)) for name in ("ann", "ben", "cleo", "ann", "ben", "cleo")]
        return await asyncio.wait_for(asyncio.gather(begun, *sent), 20)

    id, *accepted = run(database_url, at_once)
    assert all(a.fresh for a in accepted) and read(database_url, regrades.find, id).total == 3
    places = (
        "SELECT min(priority), max(priority) FROM procrastinate_jobs JOIN grading a ON a.id::text ="
        " args->>'attempt' WHERE kind = "
    )
    ((first, _),), ((_, last),) = (
        sql(database_url, places + kind) for kind in ("'interactive'", "'regrade'")
    )
    assert first > last  # who waits for a first result goes before


def test_a_submission_has_one_open_preview(database_url):
    ann, ben = graded(database_url, "ann", "-"), graded(database_url, "ben", "-")
    first = begin(database_url)
    with pytest.raises(NothingToGrade):
        begin(database_url)
    grade_open(database_url, {ann: "+"})
    second = begin(database_url)
    assert read(database_url, regrades.find, second).total == 1, "only Ann's preview has its result"
    assert sorted(submission for submission, _ in open_gradings(database_url)) == sorted([ann, ben])
    grade_open(database_url, {ann: "+", ben: "+"})
    assert run(database_url, lambda d: regrades.apply(d, second, "prof")) == 1
    rows = {row.submission: row.overtaken for row in read(database_url, regrades.score_changes, first)}
    assert rows == {ann: True, ben: False}
    assert run(database_url, lambda d: regrades.apply(d, first, "prof")) == 1
    assert points(database_url, ann) == points(database_url, ben) == 1
    assert len(run(database_url, lambda d: regrades.of_assignment(d, "rigid-body"))) == 2


def test_lateness_is_decided_by_submission_time(database_url):
    sql(database_url, "UPDATE assignment SET due_at = now() + interval '1 s' WHERE slug = 'rigid-body'")
    id = graded(database_url, "ann", "-")
    late = sql(database_url, "SELECT late FROM submission")
    sql(database_url, "UPDATE assignment SET due_at = now() - interval '1 day'")
    made = begin(database_url)
    grade_open(database_url, {id: "+"})
    run(database_url, lambda d: regrades.apply(d, made, "prof"))
    assert sql(database_url, "SELECT late FROM submission") == late == [(False,)]


def test_a_preview_tells_lateness_as_every_page_does(database_url):
    run(database_url, lambda d: d.ping())
    sql(database_url, "UPDATE assignment SET due_at = now() - interval '1 min', grace_s = 3600")
    id = graded(database_url, "ann", "-")
    made = begin(database_url, id)
    assert read(database_url, regrades.score_changes, made)[0].late
    sql(database_url, "UPDATE assignment SET due_at = now() + interval '1 day'")
    assert (
        not read(database_url, regrades.score_changes, made)[0].late
        and not run(database_url, lambda d: records.read(d, id)).late
    )
