"""The draws that an author's file declares."""

import numpy as np
import pytest

from exercises.authoring.kinds.values import values
from exercises.authoring.questions.author import Tolerance, with_ends


@pytest.mark.parametrize(
    ("draw", "middle"), [(with_ends(-2.0, 8.0), 3.0), (with_ends(0.05, 32.0, log=True), np.sqrt(1.6))]
)
def test_an_ended_draw_has_each_end_in_a_fifth_of_cases(draw, middle):
    rng = np.random.default_rng(1)
    drawn = np.array([draw(rng) for _ in range(4000)])
    low, high = drawn.min(), drawn.max()
    assert (low, high) in {(-2.0, 8.0), (0.05, 32.0)}
    inside = drawn[(low < drawn) & (drawn < high)]
    parts = [np.mean(drawn == low), np.mean(drawn == high), np.mean(inside < middle) * len(inside) / 4000]
    assert parts == pytest.approx([0.2, 0.2, 0.3], abs=0.03)


def test_a_draw_that_takes_row_gets_the_number_of_the_input():
    def doubled(x):
        return 2 * x

    question = values(
        doubled, {"x": lambda rng, row: row + rng.uniform(0, 0.5)}, Tolerance(atol=0, reason="exact")
    )
    np.testing.assert_array_equal(np.floor(question.draw(np.random.default_rng(1), 5)["x"]), np.arange(5))
