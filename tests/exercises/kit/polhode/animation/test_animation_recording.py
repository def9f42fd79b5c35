"""Recording an animation: what matplotlib cannot draw is the student's mistake."""

import matplotlib.pyplot as plt
import pytest
from matplotlib.animation import FuncAnimation

from polhode.animation.animation_recording import record
from polhode.judging.remarks import noting
from polhode.judging.return_value import WrongAnswer


def animation(title="", size=(3, 2)):
    fig, ax = plt.subplots(figsize=size)
    plt.close(fig)
    (line,) = ax.plot([0, 1], [0, 1])
    ax.set_title(title)
    return FuncAnimation(fig, lambda k: line.set_data([0, k], [0, 1]), frames=3)


@pytest.mark.parametrize(
    ("drawing", "code", "sentence"),
    [
        ({"title": r"$\frac$"}, "raises", "ValueError"),
        ({"size": (0, 2)}, "no-animation", "no pixels"),
    ],
)
def test_what_matplotlib_cannot_draw_has_a_sentence(drawing, code, sentence):
    with pytest.raises(WrongAnswer, match=sentence) as caught:
        record(lambda: animation(**drawing), 5.0)
    assert caught.value.code == code


def test_an_animation_among_other_values_is_recorded_with_a_remark():
    made, other = animation(), animation()
    other._draw_was_started = True  # or matplotlib warns that nobody draws it
    with noting() as notes:
        assert len(record(lambda: (made._fig, made), 5.0)["at"]) == 3
    assert notes.remarks == ["the function returns the animation among other values: return it alone"]
    with pytest.raises(WrongAnswer, match="got tuple"):
        record(lambda: (made, other), 5.0)
