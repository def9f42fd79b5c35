"""The head of a submission's page: points, chips, and what stands beside the first cause."""

from datetime import UTC, datetime
from types import SimpleNamespace
from uuid import uuid4

import pytest

from polhode.judging.exercise import Motion
from polhode.judging.outcome import Diagnosis, ExerciseReport, Picture
from service.pages.submission import report_summary
from tests.support.reports import outcome, report

SIGN = Diagnosis("sign-flipped", "ω̇₃ has the opposite sign", 1.0)


def failed(id):
    return outcome(id, "fail", diagnosis=[SIGN])


def test_the_points_of_optional_functions_stand_apart_unless_an_override_mixed_them(rigid_body):
    made = [outcome(f"c{k}") for k in range(30)] + [outcome(f"b{k}", bonus=True) for k in range(4)]
    one = report(made, max_points=36, bonus_points=6, total=40)
    shown = report_summary.points(rigid_body, one, SimpleNamespace(final=34))
    assert (shown.shown, shown.most, shown.bonus) == (30, 36, ", +4 of 6 bonus") and shown.share < 84
    shown = report_summary.points(rigid_body, one, SimpleNamespace(final=30.6))
    assert (shown.shown, shown.bonus) == (30.6, ", bonus included (at most 6)")
    shown = report_summary.points(None, report(made), SimpleNamespace(final=40))
    assert (shown.most, shown.bonus, shown.share) == (34, "", 100.0)


def test_every_exercise_has_a_chip(rigid_body):
    one = report(
        exercises=[
            ExerciseReport("2", "Euler", [outcome("2-energy"), outcome("2-x", "fail", counted=False)]),
            ExerciseReport("3", "Polhodes", [outcome("3-energy", "unmeasured", cause="no")]),
            ExerciseReport("5", "Axes", [outcome("5-growth"), outcome("5-stable", "fail")]),
            ExerciseReport("6", "Cone", [outcome("6-slope"), outcome("6-moves", bonus=True)]),
        ]
    )
    found = {chip.number: (chip.state, chip.points) for chip in report_summary.chips(rigid_body, one)}
    attempted = {"2": ("pass", "1/1"), "3": ("fail", "0/1"), "5": ("part", "1/2"), "6": ("pass", "1/1 +1")}
    assert found == dict.fromkeys("14", ("none", "")) | attempted
    assert [chip.number for chip in report_summary.chips(None, one)] == ["2", "3", "5", "6"]


def rows(*points):
    return [
        SimpleNamespace(id=uuid4(), final=final, submitted_at=datetime(2026, 1, 9 - k, tzinfo=UTC))
        for k, final in enumerate(points)
    ]


@pytest.mark.parametrize(
    ("points", "own", "words"),
    [
        ((3, 5, 3), 1, "this one counts"),
        ((5, 5), 0, "this one counts"),
        ((5, 5), 1, "a later one counts, with"),
        ((3, 5), 0, "an earlier one counts, with"),
        ((None, 4), 1, "this one counts"),
    ],
)
def test_whether_it_counts_is_said(points, own, words):
    known = rows(*points)
    found = report_summary.standing(known[own], known)
    assert found.words == words and (found.other is None) == (words == "this one counts")


def test_without_points_nothing_is_said():
    known = rows(None, 4)
    assert report_summary.standing(known[0], known) is None


def test_beside_the_first_cause_stands_what_shows_it(rigid_body):
    player = Motion("torque-free", "The body", "", "torque-free", (1.0, 1.0, 1.0), 2)
    omega, film = Picture("omega", "2", "ω", ""), Picture("precession", "6", "Film", "")
    euler = [ExerciseReport("2", "Euler", [failed("2-motion")])]
    drawn = [ExerciseReport("6", "Film", [failed("6-follows")])]
    beside = report_summary.beside
    assert beside(rigid_body, report(exercises=euler, figures=[omega]), {"2": [player]}) is player
    assert beside(rigid_body, report(exercises=euler, figures=[omega]), {}) is omega
    other = Motion("precession", "Attitude", "", "precession", (1.0, 1.0, 1.0), 2)
    assert beside(rigid_body, report(exercises=drawn, animations=[film]), {"6": [other]}) is film
    assert beside(rigid_body, report(exercises=drawn), {"6": [other]}) is other
    assert beside(rigid_body, report([outcome("2-motion")], figures=[omega]), {}) is None
