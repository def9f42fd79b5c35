"""A person's own history: their submissions and nobody else's."""

from service.store import history
from tests.support.database import run
from tests.support.submissions import submitted


def test_a_history_has_the_persons_own_submissions_only(url):
    first, theirs, second = (submitted(url, name)[0] for name in ("ann", "ben", "ann"))
    assert [one.id for one in run(url, lambda d: history.past(d, "ann", "rigid-body"))] == [second, first]
    assert [one.id for one in run(url, lambda d: history.timeline(d, "ann", "rigid-body"))] == [second, first]
    assert [one.id for one in run(url, lambda d: history.past(d, "ben", "rigid-body"))] == [theirs]
    assert run(url, lambda d: history.past(d, "nobody", "rigid-body")) == []


def test_the_submission_before_is_of_the_same_person(url):
    first, _, second = (submitted(url, name)[0] for name in ("cleo", "dan", "cleo"))
    assert run(url, lambda d: history.before(d, second)) == first
    assert run(url, lambda d: history.before(d, first)) is None
