"""Motions are integrated, and an early end is said in the student's terms."""

import functools

import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.animation import FuncAnimation, writers

import reference
from polhode.animation import animate
from polhode.judging.remarks import noting
from polhode.judging.return_value import WrongAnswer
from polhode.kinds import motions, play


def refusal(function, rigid_body, scene="torque-free"):
    with pytest.raises(WrongAnswer) as refused, np.errstate(all="ignore"):
        play(rigid_body.scene(scene).question, {"euler_eqs": function}, rigid_body.scene(scene).inputs)
    return refused.value


GROWING = [
    lambda t, w, I: w**3,
    lambda t, w, I: I * w * abs(w),
    lambda t, w, I: (np.roll(I, 1) + np.roll(I, 2)) * np.roll(w, 1) * np.roll(w, 2) / I,
]


@pytest.mark.parametrize("function", GROWING)
@pytest.mark.parametrize("scene", ["torque-free", "precession"])
def test_a_motion_that_blows_up_says_that_energy_is_not_conserved(function, scene, rigid_body):
    refused = refusal(function, rigid_body, scene)
    assert refused.code == "unbounded"
    assert str(refused).startswith("ω grows without bound (energy is not conserved)")


def test_other_ends_keep_their_own_words(rigid_body):
    assert refusal(lambda t, w, I: w * np.nan, rigid_body).code == "not-finite"
    stalled = refusal(lambda t, w, I: 1e3 * np.sign(np.sin(1e7 * t)) * w / abs(w), rigid_body)
    assert stalled.code is None and "stalled" in str(stalled)


def animated(rigid_body, before=None, after=None):
    """What the play of the film brings for a function that may do something ``before`` and ``after`` it makes
    its animation.
    """

    def animate_precession(t, R, L):
        fig, ax = plt.subplots(figsize=(1, 1))
        (line,) = ax.plot([0, 1], [0, 1])
        if before:
            before()
        anim = FuncAnimation(
            fig, lambda k: line.set_data([0, R[k, 0, 2]], [0, R[k, 1, 2]]), frames=12, cache_frame_data=False
        )
        anim._draw_was_started = True  # or matplotlib warns that nobody looked at it
        if after:
            after(anim)
        plt.close(fig)
        return anim

    with animate.watched():
        return play(rigid_body.scene("film").question, {"animate_precession": animate_precession}, {})


def refuse(error):
    raise error


def test_an_animation_that_could_not_be_written_or_read_again_is_judged(rigid_body):
    assert animated(rigid_body)["cost"][5] == 0
    for after in (
        lambda anim: refuse(FileNotFoundError("no usable temporary directory")),
        lambda anim: (anim.save("a.gif"), refuse(AssertionError())),
        lambda anim: writers["no such writer"],
    ):
        seen = animated(rigid_body, after=after)
        assert seen["cost"][5] == 1 and seen["cost"][0] == 12
    assert (
        animated(rigid_body, after=lambda anim: "<img" in anim.to_jshtml() or refuse(AssertionError()))[
            "cost"
        ][5]
        == 0
    )


def test_other_errors_of_an_animation_stay_errors(rigid_body):
    with pytest.raises(NameError):
        animated(rigid_body, after=lambda anim: refuse(NameError("ani")))
    with pytest.raises(OSError, match="before"):
        animated(rigid_body, before=lambda: refuse(OSError("before")))


def asked(function, rigid_body):
    points = {
        "t": np.zeros(3),
        "w": np.array([[1.0, 2, 3], [0, 0, 0], [3, -2, 1]]),
        "I": np.array([[2.0, 3, 4]] * 3),
    }
    return play(rigid_body.scene("probes").question, {"euler_eqs": function}, points)["wdot"]


@pytest.mark.parametrize("buffer", [np.zeros(3)])
def test_an_answer_that_the_next_call_overwrites_is_copied_with_a_remark(buffer, rigid_body):
    def euler_eqs(t, w, I):
        buffer[:] = reference.euler_rhs(w, I)
        return buffer

    with noting() as notes:
        found = asked(euler_eqs, rigid_body)
    assert np.array_equal(found, asked(lambda t, w, I: reference.euler_rhs(w, I), rigid_body))
    (remark,) = notes.remarks
    assert remark.startswith("euler_eqs returns the same array at each call and overwrites it")


def test_an_answer_that_is_kept_and_stays_as_it_is_passes(rigid_body):
    @functools.cache
    def kept(w, I):
        return reference.euler_rhs(np.array(w), np.array(I))

    constant = np.full(3, np.nan)
    assert np.array_equal(
        asked(lambda t, w, I: kept(tuple(w), tuple(I)), rigid_body),
        asked(lambda t, w, I: reference.euler_rhs(w, I), rigid_body),
    )
    assert np.isnan(asked(lambda t, w, I: constant, rigid_body)).all()


def test_the_tolerance_is_the_product_it_says():
    allowed = motions.as_closely({"kappa": np.array(40.0), "angle": np.array(20.0)})
    assert allowed.limit == pytest.approx(10 * 1e-11 * 60, rel=1e-2)
    assert allowed.reason == "rtol 1e-11 × (sensitivity 40 + 20 rad turned) × safety 10"
