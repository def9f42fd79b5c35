"""What accuracy costs, measured here and now on a scene of each problem."""

import time

import pytest

from reference.charts.cost import CLOSED, SAMPLES, SCIPY, Point, claims, floor, interleaved, measure
from reference.charts.scenes import EXERCISE_2, SCENES, TOP
from reference.methods import HEAVY, METHODS


@pytest.mark.slow
@pytest.mark.parametrize("scene", [EXERCISE_2, TOP], ids=lambda scene: scene.name)
def test_fresh_numbers_support_the_claims(scene):
    points = measure(scene, rounds=3)
    made = claims(points, floor(scene))
    assert len(made) == 3 and all(claim.holds for claim in made), made
    methods = HEAVY if scene.mgl else METHODS
    assert {p.method for p in points} == {m.name for m in methods} | {CLOSED, SCIPY}
    assert all(p.seconds > 0 and p.calls > 0 for p in points)
    assert [p.setting for p in points if p.method == CLOSED] == [*SAMPLES]


@pytest.mark.slow
def test_the_cheapest_stepper_is_told_also_where_it_is_cheaper_than_the_closed_form():
    points = [
        Point(CLOSED, 41, 0.0, 1, 2e-4),
        Point(CLOSED, 2000, 0.0, 1, 4e-4),
        Point(SCIPY, 1e-9, 1e-9, 1000, 1e-2),
        Point("DOP853", 1e-9, 1e-9, 1000, 3e-4),
        Point("RK8", 4.0, 1e-10, 2000, 1e-4),
        Point("RK4", 4.0, 1e-3, 100, 1e-6),
    ]
    sentences = [claim.sentence for claim in claims(points, 1e-14)]
    assert "RK8, 100 µs: less than the closed form" in sentences[-1] and "×33" in sentences[0]
    assert "No stepper reaches 1e-08" in claims([p._replace(error=1.0) for p in points], None)[-1].sentence
    assert not claims([p._replace(seconds=1e-4) for p in points], 1e-14)[0].holds


def test_runs_take_turns_and_a_time_is_the_median_of_its_rounds():
    order: list[str] = []

    def slow() -> None:
        order.append("slow")
        until = time.process_time() + 0.003
        while time.process_time() < until:
            pass

    found = interleaved({"slow": slow, "slower": lambda: (slow(), slow())}, rounds=3)
    assert found["slow"] == pytest.approx(0.003, rel=0.2) and found["slower"] == pytest.approx(0.006, rel=0.2)
    assert len(order) == 3 + 3 * 3, "each once to see how long it takes, then three rounds"


def test_the_floor_is_that_of_a_free_body_only():
    assert floor(TOP) is None and floor(EXERCISE_2) == pytest.approx(2.2e-14, rel=0.1)
    assert len({scene.name for scene in SCENES}) == len(SCENES) >= 6
