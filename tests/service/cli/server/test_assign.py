"""polhode assign, run in this process on a database."""

import pytest

from tests.support.command_line import polhode
from tests.support.database import run, sql

RULES = (
    "SELECT due_at AT TIME ZONE 'UTC', grace_s, submission_limit, weight FROM assignment WHERE slug ="
    " 'rigid-body'"
)


@pytest.fixture
def assign(database_url, monkeypatch):
    """Run ``polhode assign rigid-body`` and return its line and the rules stored."""
    monkeypatch.setenv("POLHODE_DATABASE_URL", database_url)

    async def nothing(database):
        pass

    run(database_url, nothing)  # registers the assignments

    def assign(*options):
        code, line, errors = polhode("assign", "rigid-body", *options)
        assert (code, errors) == (0, "")
        ((due, *others),) = sql(database_url, RULES)
        return line, [due and due.isoformat(), *others]

    return assign


def test_options_that_are_not_given_stay_unchanged(assign):
    assert assign("--due", "2026-12-01T12:00+01:00", "--grace", "60")[1] == [
        "2026-12-01T11:00:00",
        60.0,
        None,
        1.0,
    ]
    line, rules = assign("--most", "3")
    assert rules == ["2026-12-01T11:00:00", 60.0, 3, 1.0]
    assert (
        line == "rigid-body: due 2026-12-01T11:00:00+00:00, grace period 60 s, 3 submissions per student,"
        " weight 1\n"
    )
    assert assign("--due", "2026-12-02T00:00Z")[1] == ["2026-12-02T00:00:00", 60.0, 3, 1.0]
    assert assign() == (line.replace("2026-12-01T11", "2026-12-02T00"), ["2026-12-02T00:00:00", 60.0, 3, 1.0])


def test_each_rule_can_be_removed(assign, database_url):
    assign("--due", "2026-12-01T12:00Z", "--grace", "60", "--most", "3")
    assert assign("--due", "none")[1] == [None, 60.0, 3, 1.0]
    assert assign("--most", "none")[1] == [None, 60.0, None, 1.0]
    line, rules = assign("--grace", "0", "--weight", "2.5")
    assert rules == [None, 0.0, None, 2.5]
    assert (
        line == "rigid-body: no deadline, grace period 0 s, unlimited submissions per student, weight 2.5\n"
    )
    assign()
    recorded = [
        row[0]
        for row in sql(
            database_url, "SELECT detail FROM audit WHERE action = 'assignment settings' ORDER BY id"
        )
    ]
    assert len(recorded) == 4, "showing the settings is no change"
    assert recorded[1]["due_at"]["new"] is None and recorded[1]["due_at"]["old"].endswith("+00:00")
    assert recorded[3]["weight"] == {"old": 1.0, "new": 2.5} and recorded[3]["grace_s"]["new"] == 0.0


def test_it_can_be_hidden_until_a_time(assign):
    line, _ = assign("--available-from", "2026-11-01T08:00+01:00")
    assert line.startswith("rigid-body: available from 2026-11-01T07:00:00+00:00, no deadline, ")
    assert "available" not in assign("--available-from", "none")[0]


def test_it_is_published_and_made_a_draft_again(assign):
    assert assign("--draft")[0].startswith("rigid-body: draft, no deadline, ")
    assert assign("--due", "2026-12-01T12:00Z")[0].startswith("rigid-body: draft, due ")
    assert assign("--publish")[0].startswith("rigid-body: due ")
