"""A person's own history: their submissions and nobody else's."""

from service.store.submissions import records
from service.store.submissions.past_submissions import past_submissions, previous, timeline
from tests.support.database import run
from tests.support.submissions import graded, submitted


def test_a_history_has_the_persons_own_submissions_only(url):
    first, theirs, second = (submitted(url, name)[0] for name in ("ann", "ben", "ann"))
    assert [one.id for one in run(url, lambda d: past_submissions(d, "ann", "rigid-body"))] == [
        second,
        first,
    ]
    assert [one.id for one in run(url, lambda d: timeline(d, "ann", "rigid-body"))] == [
        second,
        first,
    ]
    assert [one.id for one in run(url, lambda d: past_submissions(d, "ben", "rigid-body"))] == [theirs]
    assert run(url, lambda d: past_submissions(d, "nobody", "rigid-body")) == []


def test_lists_have_the_total_of_the_report(url):
    id = graded(url, "eve", "+-", total=36, not_attempted=["1"])
    for found in (past_submissions, timeline):
        (one,) = run(url, lambda d, f=found: f(d, "eve", "rigid-body"))
        assert (one.id, one.total) == (id, 36)
    (one,) = run(url, lambda d: records.recent(d, 9, "eve"))
    assert (one.id, one.total) == (id, 36)


def test_the_submission_before_is_of_the_same_person(url):
    first, _, second = (submitted(url, name)[0] for name in ("cleo", "dan", "cleo"))
    assert run(url, lambda d: previous(d, second)) == first
    assert run(url, lambda d: previous(d, first)) is None
