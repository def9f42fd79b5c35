"""The task on an assignment's page."""

from types import SimpleNamespace

from service.pages.submission import exercise_list


def test_each_exercise_has_its_names_points_and_progress(rigid_body):
    counted = SimpleNamespace(verdicts={"2-energy": "pass", "2-motion": "fail", "4-function": "pass"})
    found = {one.number: one for one in exercise_list.exercises(rigid_body, counted)}
    assert sum(one.points for one in found.values()) == rigid_body.most_points
    assert sum(one.bonus for one in found.values()) == rigid_body.bonus_points()
    assert found["4"].names == ("euler_eqs", "precession_rate") and found["4"].bonus == 4
    assert [(n, one.passed, one.made) for n, one in found.items() if one.made] == [("2", 1, 2), ("4", 1, 1)]
    assert not any(one.made for one in exercise_list.exercises(rigid_body, None))


def test_what_a_submission_may_use_is_said(rigid_body):
    assert exercise_list.limits(rigid_body) == (
        "numpy, scipy, matplotlib; at most 15 s for one calculation; no network"
    )
