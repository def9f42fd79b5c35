"""What is asked about notebook.ipynb, which holds the text for students, the Setup and the solutions."""

import numpy as np
import scipy.linalg
import scipy.special

from exercises.authoring import Notebook, absolute, array_of, between, normal, relative

notebook = Notebook(
    "notebook.ipynb",
    title="The pendulum",
)


@notebook.exercise("1", points=4)
def period_of_a_pendulum(ask):
    """The period for any amplitude."""
    period = ask.function("period")
    period.case("any amplitude", l=between(0.1, 5), g=between(1, 20), amplitude=between(0.1, 3))

    @period.truth(
        agree=relative(1e-12, because="two forms of the formula differ by a few roundings of 1e-15")
    )
    def by_elliptic_integral(l, g, amplitude):
        """The complete elliptic integral of the first kind, where the solution has its mean."""
        return 4 * np.sqrt(l / g) * scipy.special.ellipk(np.sin(amplitude / 2) ** 2)

    period.mistake("missing-term", "the period does not depend on the amplitude", change=" / a -> ")
    period.mistake("constant-factor", "half of the period is returned", change="2 * np.pi -> np.pi")


@notebook.draw
def oscillator(draw):
    """Return an oscillator with weak damping, and a time within a few periods."""
    omega0 = draw(between(1, 3))
    gamma = omega0 * draw(between(0.05, 0.5))
    return {"t": draw(between(0.5, 5)), "start": draw(array_of(2, normal)), "gamma": gamma, "omega0": omega0}


@notebook.exercise("2", points=6)
def damped_oscillator(ask):
    """The displacement of an oscillator with weak damping."""
    displacement = ask.function("displacement", inputs=oscillator)

    @displacement.truth(
        agree=absolute(1e-12, because="the matrix exponential is exact to 1e-14, |x| is below 6")
    )
    def by_matrix_exponential(t, start, gamma, omega0):
        """The exponential of the equation written as two of first order."""
        return (scipy.linalg.expm(t * np.array([[0, 1], [-(omega0**2), -2 * gamma]])) @ start)[0]

    displacement.mistake(
        "missing-term", "damping lowers the frequency", change="omega0**2 - gamma**2 -> omega0**2"
    )
    displacement.mistake("sign-flipped", "the amplitude grows", change="exp(-gamma -> exp(gamma")

    @displacement.mistake("missing-term", "x' at t = 0 is not the given one")
    def without_damping_at_the_start(t, start, gamma, omega0):
        x, v = start
        return displacement(t, np.array([x, v - gamma * x]), gamma, omega0)
