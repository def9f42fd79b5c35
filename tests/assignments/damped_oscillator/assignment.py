"""The equation of motion of a damped oscillator, its values and its motion, which has a closed form."""

import numpy as np

from exercises.authoring import Notebook, array_of, between, relative

notebook = Notebook("notebook.ipynb")


@notebook.draw
def weakly_damped(draw):
    """Return a time, a state, and an oscillator with γ < ω."""
    omega = draw(between(0.5, 4.0))
    gamma = omega * draw(between(0.05, 0.9))
    return {"y": draw(array_of(2, between(-2.0, 2.0))), "omega": omega, "gamma": gamma}


@notebook.exercise("1", "The equation of motion")
def equation_of_motion(ask):
    """The derivatives of x and v, and the motion over 20 s."""
    oscillator = ask.right_hand_side(
        "oscillator",
        weakly_damped,
        until=20.0,
        follow=relative(1e-6, because="the integrator, at rtol 1e-9, stays within 1e-7 of the closed form"),
        budget_s=10.0,
    )

    @oscillator.truth(agree=relative(1e-12, because="correct formulas differ by a few roundings"))
    def linear(t, y, omega, gamma):
        """The equation as a matrix."""
        return np.array([[0.0, 1.0], [-(omega**2), -2 * gamma]]) @ y

    @oscillator.motion
    def closed_form(t, y, omega, gamma):
        """A decaying oscillation of the frequency √(ω² − γ²)."""
        w, (x, v) = np.sqrt(omega**2 - gamma**2), y
        decay, cos, sin = np.exp(-gamma * t), np.cos(w * t), np.sin(w * t)
        first = x * cos + (v + gamma * x) / w * sin
        return decay * np.array([first, v * cos - (gamma * v + omega**2 * x) / w * sin])

    oscillator.mistake(
        "constant-factor", "the damping is half as large: its term is −2γv", change="2 * gamma -> gamma"
    )
