"""Comments on source lines: in the order of the lines, deleted ones stay in the audit log."""

from service.store.course.comments import delete, of_submission, write
from tests.support.database import run, sql
from tests.support.submissions import graded


def written(url, submission, cell, line, comment, author="prof"):
    return run(url, lambda d: write(d, submission, author, cell=cell, line=line, comment=comment))


def test_comments_are_listed_by_line(database_url):
    sent, other = (graded(database_url, "ann", "+") for _ in range(2))
    places = ((2, 1, "d"), (1, 3, "b"), (1, 1, "a"), (1, 3, "c"))
    made = [written(database_url, sent, *place) for place in places]
    found = run(database_url, lambda d: of_submission(d, sent))
    assert [(one.cell, one.line, one.comment) for one in found] == [
        (1, 1, "a"),
        (1, 3, "b"),
        (1, 3, "c"),
        (2, 1, "d"),
    ]
    assert made[0] == found[-1] and found[0].author == "prof"
    assert not run(database_url, lambda d: of_submission(d, other))


def test_a_deleted_comment_stays_in_the_audit_log(database_url):
    sent, other = (graded(database_url, "ann", "+") for _ in range(2))
    one = written(database_url, sent, 1, 1, "wrong sign")
    assert not run(database_url, lambda d: delete(d, other, one.id, "tutor"))
    assert run(database_url, lambda d: delete(d, sent, one.id, "tutor"))
    assert not run(database_url, lambda d: delete(d, sent, one.id, "tutor"))
    assert not run(database_url, lambda d: of_submission(d, sent))
    assert sql(database_url, "SELECT actor, action, subject, detail->>'comment' FROM audit ORDER BY id") == [
        ("prof", "comment", str(sent), "wrong sign"),
        ("tutor", "comment deleted", str(sent), "wrong sign"),
    ]
