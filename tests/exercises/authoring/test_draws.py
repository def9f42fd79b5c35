"""Draws: ranges, ends, arrays, and what belongs together."""

import math

import numpy as np
import pytest

from exercises.authoring import draws
from polhode.kinds import student_calls

RNG = np.random.default_rng


@pytest.mark.parametrize(
    ("draw", "middle"),
    [(draws.with_ends(-2.0, 8.0), 3.0), (draws.with_ends(0.05, 32.0, log=True), np.sqrt(1.6))],
)
def test_an_ended_draw_has_each_end_in_a_fifth_of_cases(draw, middle):
    rng = RNG(1)
    drawn = np.array([draw(rng) for _ in range(4000)])
    low, high = drawn.min(), drawn.max()
    assert (low, high) in {(-2.0, 8.0), (0.05, 32.0)}
    inside = drawn[(low < drawn) & (drawn < high)]
    parts = [np.mean(drawn == low), np.mean(drawn == high), np.mean(inside < middle) * len(inside) / 4000]
    assert parts == pytest.approx([0.2, 0.2, 0.3], abs=0.03)


def test_an_array_has_its_shape_and_independent_numbers():
    drawn = draws.array_of((2, 3), draws.between(0, 1))(RNG(1))
    assert drawn.shape == (2, 3) and len(set(drawn.ravel())) == 6


def test_an_angle_lies_within_one_turn():
    drawn = [draws.angle(RNG(seed)) for seed in range(100)]
    assert -math.pi <= min(drawn) < -2 and 2 < max(drawn) <= math.pi


def test_a_joint_draw_gives_values_of_one_draw():
    joint = draws.JointDraw(lambda draw: dict.fromkeys("ab", draw(draws.between(0, 1))))
    values = joint(RNG(2))
    assert joint["a"].of(values) == joint["b"].of(values)
    assert joint.names == ("a", "b")


def test_a_name_that_is_not_drawn_is_named():
    joint = draws.JointDraw(lambda draw: {"a": 1.0})
    with pytest.raises(LookupError, match=r"does not return b; it returns a"):
        joint["b"](RNG(0))


def test_cases_of_a_joint_draw_take_turns():
    first, second = (draws.JointDraw(lambda draw, a=a: {"a": a}) for a in (1, 2))
    joint = draws.in_turn(first, second)
    assert [joint(RNG(0), row)["a"] for row in range(5)] == [1, 2, 1, 2, 1]
    assert joint.names == ("a",)


def test_a_function_of_the_file_is_an_argument_with_what_it_uses():
    family = draws.function(pulled_back, rate=draws.between(1, 2))
    pull = student_calls.expression(family.text, family.over, {"rate": 2.0})
    assert family.over == ("x",) and pull(3.0) == -12.0 and pull([1.0, 2.0]).tolist() == [-4.0, -8.0]


FACTOR = 2.0


def force(x):
    return -FACTOR * x


def pulled_back(x, rate):
    return rate * force(x)


def test_a_joint_draw_must_return_a_dict():
    with pytest.raises(TypeError, match="must return a dict"):
        draws.JointDraw(lambda draw: 3)(RNG(0))
