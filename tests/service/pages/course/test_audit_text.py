"""The audit log in words."""

from datetime import UTC, datetime
from types import SimpleNamespace

import pytest

from service.http import templating
from service.pages.course.audit_text import Value, tell


def told(action, detail, subject="ann"):
    return tell(
        SimpleNamespace(at=datetime.now(UTC), actor="prof", action=action, subject=subject, detail=detail)
    )


@pytest.mark.parametrize(
    ("name", "old", "new", "words"),
    [
        ("due_at", None, "2026-12-01T11:00:00+00:00", ("deadline", "none", "2026-12-01 12:00")),
        ("grace_s", 0.0, 5400.0, ("grace period", "0 min", "90 min")),
        ("late_penalty", 0.0, 0.1, ("late penalty per day", "0 %", "10 %")),
        ("submission_limit", 3, None, ("submissions per person", "3", "none")),
        ("title", "", "Mechanics", ("name", "none", "Mechanics")),
        ("weight", 1.0, 2.5, ("weight", "1.0", "2.5")),
    ],
)
def test_a_change_has_the_old_and_the_new_value_in_the_time_zone_of_the_course(name, old, new, words):
    zone = templating.ZONE.set(templating.find_zone("Europe/Berlin"))
    try:
        entry = told("assignment settings", {name: {"old": old, "new": new}}, "rigid-body")
    finally:
        templating.ZONE.reset(zone)
    assert entry.values == [Value(*words)] and entry.action == "changed the settings of"
    assert "Rigid-Body" in entry.about


def test_submissions_and_regrades_have_a_page():
    id = "12345678-1234-1234-1234-123456789012"
    entry = told("override", {"person": "ann", "check": None, "points": {"old": 1, "new": 2}}, id)
    assert (entry.about, entry.kind) == ("submission 12345678", "submission")
    assert entry.values == [Value("person", "", "ann"), Value("points", "1", "2")]
    assert told("regrade begun", {}, id).kind == "regrade"
    assert told("course settings", {}, "local").about == "the course"
    assert told("release", {"scores": True, "details": False}).values == [
        Value("scores", "", "yes"),
        Value("details", "", "no"),
    ]


def test_an_action_without_words_is_shown_as_it_is():
    entry = told("danced", {"with": ["bo", "cem"]})
    assert (entry.action, entry.about, entry.values) == ("danced", "ann", [Value("with", "", "bo, cem")])
