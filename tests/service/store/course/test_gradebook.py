"""Where every student stands: which submission counts, what a check came to, what is late,
what is forgiven.
"""

from datetime import UTC, datetime, timedelta

import pytest

from service.store.course import assignment_settings, deadlines, gradebook
from service.store.people import people
from tests.support.database import run, sql
from tests.support.submissions import hand_in

GOOD, BAD = {"2-energy": "✓", "2-momentum": "✓"}, {"2-energy": "✓", "2-momentum": ("✗", 1e-3)}
NOW = datetime.now(UTC)


def standing(url, name):
    return next(
        s for s in run(url, lambda database: gradebook.students(database, "rigid-body")) if s.name == name
    )


def test_the_best_counts_of_equals_the_newest_and_who_sent_nothing_is_there(database_url):
    async def fill(database):
        async with database.begin() as connection:
            await people.enroll(
                connection, [("zoe", "student", "Zoe Adams"), ("prof", "instructor"), ("gone", "former")]
            )
        _, new = [await hand_in(database, "ann", GOOD, days_ago=days) for days in (3, 2)]
        await hand_in(database, "ann", BAD, days_ago=1)
        await hand_in(database, "ann", None)
        await hand_in(database, "gone", GOOD)
        return new

    counts = run(database_url, fill)
    ann, zoe = standing(database_url, "ann"), standing(database_url, "zoe")
    assert (ann.submission, ann.points, ann.max_score, ann.submissions, ann.status) == (
        counts,
        2,
        2,
        4,
        "graded",
    )
    assert (
        ann.earned == [2, 2, 1, None]
        and ann.sent_at == sorted(ann.sent_at)
        and (zoe.earned, zoe.sent_at) == ([], [])
    )
    assert (zoe.submission, zoe.points, zoe.submissions, zoe.status, zoe.display_name) == (
        None,
        None,
        0,
        "no submission",
        "Zoe Adams",
    )
    listed = [s.name for s in run(database_url, lambda database: gradebook.students(database, "rigid-body"))]
    assert listed == ["zoe", "ann"]  # by surname: Adams, ann
    row = run(database_url, lambda database: gradebook.rules(database, "rigid-body"))
    assert (row.submitted, row.students, row.open, row.faults, row.regrades) == (1, 2, 1, 0, 0)


def test_points_given_count_instead(database_url):
    id = run(database_url, lambda database: hand_in(database, "ann", BAD))
    give = (
        "INSERT INTO override (submission_id, check_id, points, reason, given_by) VALUES (%s, %s, %s,"
        " 'because', 'prof')"
    )
    sql(database_url, give, id, "2-momentum", 1)
    ann = standing(database_url, "ann")
    assert (ann.score, ann.points, ann.overridden) == (1, 2, True)
    sql(database_url, give, id, None, 0)
    assert standing(database_url, "ann").points == 0
    sql(database_url, "UPDATE override SET withdrawn_at = now()")
    assert (standing(database_url, "ann").points, standing(database_url, "ann").overridden) == (1, False)


def test_a_held_grading_changes_nothing(database_url):
    run(database_url, lambda database: hand_in(database, "ann", BAD))
    sql(
        database_url,
        """WITH one AS (INSERT INTO grading (id, submission_id, number, kind, seed, max_runs, preview)
            SELECT gen_random_uuid(), id, 2, 'regrade', 7, 3, true FROM submission RETURNING id)
        INSERT INTO result (grading_id, score, max_score, report, version) SELECT one.id, 2, 2, r.report, '2'
          FROM one, result r""",
    )
    assert (standing(database_url, "ann").points, standing(database_url, "ann").version) == (1, "1")


def set_rules(url, due, grace=3600.0):
    run(
        url,
        lambda database: assignment_settings.change(
            database, "rigid-body", {"due_at": due, "grace_s": grace}, "prof"
        ),
    )


def test_a_later_deadline_forgives_and_an_earlier_one_makes_nobody_late(database_url):
    set_rules(database_url, NOW - timedelta(minutes=30))
    run(database_url, lambda database: hand_in(database, "ann", GOOD))
    run(database_url, lambda database: hand_in(database, "ben", GOOD, days_ago=1))
    assert [standing(database_url, name).late for name in ("ann", "ben")] == [True, False]
    given = {"reason": "was ill", "by": "prof"}
    later = NOW + timedelta(days=1)
    assert run(database_url, lambda database: deadlines.extend(database, "rigid-body", "ann", later, **given))
    assert not standing(database_url, "ann").late
    assert run(
        database_url, lambda database: deadlines.remove_extension(database, "rigid-body", "ann", "prof")
    )
    assert not run(
        database_url, lambda database: deadlines.remove_extension(database, "rigid-body", "ann", "prof")
    )
    assert standing(database_url, "ann").late
    set_rules(database_url, NOW - timedelta(days=3))
    assert not standing(database_url, "ben").late
    set_rules(database_url, None)
    assert not standing(database_url, "ann").late
    assert [row[0] for row in sql(database_url, "SELECT action FROM audit ORDER BY id")] == [
        "assignment settings", "extension", "extension taken back", "assignment settings",
        "assignment settings",
    ]  # fmt: skip


def test_an_extension_is_for_one_person_and_never_shortens(database_url):
    from service.store.submissions.accepting import SubmissionRejected

    set_rules(database_url, NOW - timedelta(days=1), grace=0.0)
    run(database_url, lambda database: hand_in(database, "ann", None, days_ago=2))
    with pytest.raises(SubmissionRejected):
        run(database_url, lambda database: hand_in(database, "ann", None))
    given = {"reason": "was ill", "by": "prof"}
    assert run(
        database_url, lambda d: deadlines.extend(d, "rigid-body", "ann", NOW + timedelta(days=1), **given)
    )
    run(database_url, lambda database: hand_in(database, "ann", None))
    with pytest.raises(SubmissionRejected):
        run(database_url, lambda database: hand_in(database, "ben", None))
    set_rules(database_url, NOW + timedelta(days=9), grace=0.0)
    run(database_url, lambda database: hand_in(database, "ann", None, days_ago=-3))
    assert not run(database_url, lambda d: deadlines.extend(d, "rigid-body", "nobody", NOW, **given))
