"""Tools of computational physics: what is asked about notebook.ipynb, questions of nearly all kinds.

Tests count on the numbers of exercises and on the order of mistakes. A mistake without words must fail, and
gives no hint.
"""

from math import pi, sqrt

import numpy as np

from exercises.authoring import (
    Notebook,
    Value,
    absolute,
    array_of,
    at_most,
    between,
    close,
    expression,
    generator,
    integer,
    normal,
    relative,
    rk4,
)

notebook = Notebook("notebook.ipynb")

a_few_roundings = "a few rounding errors of the summed terms"
rounding = relative(1e-13, because=a_few_roundings)
integrated = "a hundred times the error of the integration"
first_steps = "the slope still bends at the first steps"


@notebook.exercise("1", points=16, partial=True)
def a_root_finder(ask):
    """The root of Kepler's equation E − e sin E = M, by bisection in at most 60 calls."""
    find_root = ask.function("find_root", calls=at_most(60, because="bisection needs 42"))
    find_root.case(
        "",
        f=expression("E - e*sin(E) - M", of="E", M=between(0.01, 3.1), e=between(0, 0.99)),
        a=0.0,
        b=pi,
        tol=1e-12,
    )

    @find_root.truth(agree=absolute(2e-12, because="tol, twice"))
    def by_newtons_method(M, e):
        E = pi
        for _ in range(80):
            E -= (E - e * np.sin(E) - M) / (1 - e * np.cos(E))
        return E

    find_root.mistake(
        "sign-flipped", "the search keeps the half without the root", change="f(m) < 0 -> f(m) > 0"
    )
    find_root.mistake("precision-loss", "the search stops at 1e-6 whatever tol is", change="> tol -> > 1e-6")

    @find_root.mistake()
    def looks_at_61_points_first(f, a, b, tol):
        for x in np.linspace(a, b, 61):
            f(x)
        return find_root(f, a, b, tol)


@notebook.draw
def three_masses(draw):
    """Return a diagonal matrix of masses, and a symmetric stiffness with different frequencies."""
    M = np.diag(draw.rng.uniform(0.5, 3, 3))
    B = draw(array_of((3, 3), normal))
    return {"M": M, "K": B @ B.T + np.diag([0.2, 1, 2])}


@notebook.exercise("2")
def normal_modes(ask):
    """The frequencies and the modes of three masses."""
    modes = ask.function("normal_modes", three_masses, returns="omega X")

    @modes.truth
    def of_the_symmetric_matrix(M, K):
        """Both from the eigenvectors of M^(-1/2) K M^(-1/2)."""
        root = np.diag(np.diag(M) ** -0.5)
        w2, U = np.linalg.eigh(root @ K @ root)
        return np.sqrt(w2), root @ U

    modes.agree(
        omega=relative(1e-10, because=a_few_roundings),
        X=Value(relative(1e-9, because=a_few_roundings), up_to="column signs"),
    )
    modes.mistake("missing-term", "the square root of the eigenvalues is missing", change="np.sqrt(w2) -> w2")
    modes.mistake("missing-term", "the masses are missing", change="eigh(K, M) -> eigh(K)")
    modes.mistake(
        "transposed-rotation", "the modes are rows instead of columns", change="(w2), X -> (w2), X.T"
    )


@notebook.exercise("3")
def a_class(ask):
    """The period of a pendulum, which a method returns."""
    pendulum = ask.function("Pendulum")
    pendulum.case("", call="Pendulum(l, g).period()", l=between(0.1, 9), g=between(1, 20))

    @pendulum.truth(agree=rounding)
    def of_small_oscillations(l, g):
        """An object with the period, as that of the class has it."""
        return Exact(2 * np.pi * (l / g) ** 0.5)

    pendulum.mistake("constant-factor", "half of the period is returned", change="2 * pi -> pi")


class Exact:
    """A pendulum of an exact period."""

    def __init__(self, T):
        self.T = T

    def period(self):
        return self.T


@notebook.exercise("4")
def the_damped_oscillator(ask):
    """The derivatives of x and v, and the motion over 10 s, which has a closed form."""
    oscillator = ask.right_hand_side("oscillator", until=10.0, follow=relative(1e-8, because=integrated))
    oscillator.case(
        "",
        t=between(0, 9),
        y=array_of(2, between(-2, 2)),
        w=between(1, 4),
        g=between(0.1, 0.9),
    )
    oscillator.agree(rounding)

    @oscillator.motion
    def decaying(t, y, w, g):
        """Position and velocity oscillate with the frequency √(w² − g²)."""
        v = sqrt(w**2 - g**2)
        x = y[0] * np.cos(v * t) + (y[1] + g * y[0]) / v * np.sin(v * t)
        rate = y[1] * np.cos(v * t) - (w**2 * y[0] + g * y[1]) / v * np.sin(v * t)
        return np.exp(-g * t) * x, np.exp(-g * t) * rate

    oscillator.mistake("sign-flipped", "the spring pushes away", change="-(w**2) -> w**2")
    oscillator.mistake("constant-factor", "half of the damping", change="2 * g -> g")
    oscillator.mistake("missing-term", "there is no damping", change=" - 2 * g * y[1] -> ")


@notebook.exercise("5")
def the_pendulum(ask):
    """The derivatives of angle and rate, the motion over 10 s, which has no closed form, and its energy."""
    pendulum = ask.right_hand_side(
        "pendulum",
        until=10.0,
        follow=relative(1e-7, because=integrated),
        conserved={
            "energy": (
                "y[1]**2 / 2 - g * cos(y[0])",
                at_most(1e-8, because="the error of the integration"),
            )
        },
    )
    pendulum.case("", t=0.0, y=array_of(2, between(-2, 2)), g=between(1, 9))

    @pendulum.truth(agree=rounding)
    def by_complex_numbers(y, g):
        """The sine is the imaginary part of exp(iθ)."""
        return [y[1], -g * np.imag(np.exp(1j * y[0]))]

    pendulum.mistake("missing-term", "the angle is not small", change="np.sin(y[0]) -> y[0]")
    pendulum.mistake(
        "wrong-quantity",
        "friction is added",
        change="-g * np.sin(y[0]) -> -g * np.sin(y[0]) - 1e-4 * y[1]",
    )


@notebook.exercise("6")
def a_step_of_runge_and_kutta(ask):
    """A step of fourth order with four calls of f, stable for a decay up to h = 2.785."""
    rk4_step = ask.step(
        "rk4_step",
        state="y",
        calls=at_most(4, because="four stages"),
        order=(4, absolute(0.3, because=first_steps)),
        stable_to=(2.785, close(rtol=1e-3, atol=0, because="the published limit has four digits")),
    )
    rk4_step.case(
        "",
        f=expression(
            "A @ y + b * cos(t) - c * y**3",
            of="t y",
            A=array_of((3, 3), between(-1, 1)),
            b=array_of(3, between(-1, 1)),
            c=between(0, 1),
        ),
        t=between(0, 9),
        y=array_of(3, between(-1, 1)),
        h=between(0.1, 0.4),
    )
    rk4_step.truth(rk4, agree=rounding)
    rk4_step.mistake(
        "wrong-quantity", "this is Euler's step", change="h / 6 * (k1 + 2 * k2 + 2 * k3 + k4) -> h * k1"
    )
    rk4_step.mistake(
        "constant-factor",
        "the slopes are weighted alike",
        change="k1 + 2 * k2 + 2 * k3 + k4 -> 1.5 * (k1 + k2 + k3 + k4)",
    )
    rk4_step.mistake(
        "missing-term",
        "the third slope is that of time t",
        change="f(t + h / 2, y + h / 2 * k2) -> f(t, y + h / 2 * k2)",
    )

    @rk4_step.mistake()
    def calls_f_once_more(f, t, y, h):
        f(t, y)
        return rk4_step(f, t, y, h)


@notebook.exercise("7")
def a_step_of_verlet(ask):
    """A step of second order of position and velocity, stable for an oscillation up to h = 2."""
    verlet = ask.step(
        "verlet",
        state="x v",
        order=(2, absolute(0.2, because=first_steps)),
        stable_to=(2, close(rtol=1e-3, atol=0, because="the search ends at a millionth")),
    )
    verlet.case(
        "",
        force=expression("-k * x - sin(x)", of="x", k=between(0.5, 2)),
        x=array_of(2, between(-1, 1)),
        v=array_of(2, between(-1, 1)),
        h=between(0.05, 0.4),
    )

    @verlet.rates
    def rates(force, x, v):
        return v, force(x)

    @verlet.truth(agree=rounding)
    def by_the_mean_force(force, x, v, h):
        """The velocity changes by the mean of the forces before and after the step."""
        later = x + h * v + h**2 / 2 * force(x)
        return later, v + h / 2 * (force(x) + force(later))

    verlet.mistake(
        "missing-term", "the second half kick is missing", change="half + h / 2 * force(x) -> half"
    )
    verlet.mistake("wrong-quantity", "the drift uses the old velocity", change="x + h * half -> x + h * v")


@notebook.draw
def dominant_system(draw):
    """Return a matrix with a dominant diagonal, for which Jacobi's method converges, and a right side."""
    A = draw(array_of((3, 3), between(-1, 1))) + 4 * np.eye(3)
    return {"A": A, "b": draw(array_of(3, between(-1, 1)))}


@notebook.exercise("8")
def structured_results(ask):
    """A dict of energies, and a list of all iterates of Jacobi's method."""
    energies = ask.function("energies", returns="kinetic potential", keys=True)
    energies.case("", x=between(-1, 1), v=between(-2, 2), k=between(1, 9), m=between(1, 3))

    @energies.truth(agree=close(rtol=1e-13, atol=0, because=a_few_roundings))
    def by_products(x, v, k, m):
        return {"kinetic": 0.5 * m * v * v, "potential": 0.5 * k * x * x}

    energies.mistake("constant-factor", "the kinetic energy lacks its factor 1/2", change="v**2 / 2 -> v**2")

    jacobi = ask.function("jacobi", label="every iterate of the history is right")
    jacobi.case("", dominant_system, steps=8)

    @jacobi.truth(agree=relative(1e-12, because=a_few_roundings))
    def by_a_series(A, b, steps):
        """The partial sums of the Neumann series of the splitting A = D (1 − G)."""
        D = np.diag(1 / np.diag(A))
        G = np.eye(3) - D @ A
        return np.cumsum([np.linalg.matrix_power(G, k) @ D @ b for k in range(steps)], axis=0)

    jacobi.mistake("wrong-start", "it starts at 1, not at 0", change="np.zeros(len(b)) -> np.ones(len(b))")
    jacobi.mistake(change="return history -> return [x] * steps")


@notebook.exercise("9")
def random_numbers(ask):
    """Samples with a given generator, samples with an own one, and an estimate with its error."""
    decay_times = ask.samples("decay_times", "expon", parameters={"scale": lambda tau: tau})
    decay_times.case("", n=5000, tau=between(0.5, 3), rng=generator())
    decay_times.mistake("missing-term", "the decay time is missing", change="-tau * -> -")
    decay_times.mistake(change="-tau * -> -1.05 * tau *")
    decay_times.mistake(change="rng.random(n) -> np.repeat(rng.random(n // 2), 2)")
    decay_times.mistake(
        "wrong-variable",
        "the generator is not used",
        change="rng.random(n) -> np.random.default_rng(1).random(n)",
    )
    decay_times.mistake(change="rng.random(n) -> np.random.random(n)")

    end_point = ask.samples(
        "end_point", "binom", parameters={"n": lambda steps: steps, "p": 0.5}, repetitions=1500
    )
    end_point.case("", call="(end_point(steps) + steps) / 2", steps=integer(10, 40))
    end_point.mistake(change="0.5 -> 0.6")
    end_point.mistake(change="- steps -> - steps + 1")
    end_point.mistake(change="default_rng() -> default_rng(1)")

    pi_estimate = ask.estimate(
        "pi_estimate",
        sd=lambda n: sqrt(pi * (4 - pi) / n),
        error=at_most(0.12, because="five times the spread of the error of 2000 points"),
    )
    pi_estimate.case("", n=2000)

    @pi_estimate.truth
    def area_of_the_circle():
        return pi

    pi_estimate.mistake(
        "missing-term", "the error is that of a point, not of the mean", change=" / sqrt(n) -> "
    )
    pi_estimate.mistake(change="hits.std() -> 10 * hits.std()")
    pi_estimate.mistake(change="hits.mean() -> hits.mean() + 0.02")
    pi_estimate.mistake(
        "missing-term", "only half of the points are drawn", change="random((2, n)) -> random((2, n // 2))"
    )
    pi_estimate.mistake(
        "not-deterministic",
        "every call starts with the same seed",
        change="np.random.random( -> np.random.default_rng(5).random(",
    )


TIMES = np.linspace(0, 3, 25)


@notebook.exercise("10")
def a_fit(ask):
    """Amplitude and rate of a decay, and their covariance."""

    def decay(t, A, k):
        return A * np.exp(-k * t)

    fit_decay = ask.fit(
        "fit_decay",
        decay,
        x=TIMES,
        sigma=0.02 + 0.02 * TIMES,
        drawn={"A": between(1, 4), "k": between(0.5, 2)},
        parameters=relative(1e-4, because="of its standard deviation"),
        covariance=relative(1e-4, because="of two standard deviations"),
    )
    fit_decay.mistake(
        "missing-term",
        "the errors of the data are not used",
        change="sigma=sigma, absolute_sigma=True,  -> ",
    )
    fit_decay.mistake(change="sigma=sigma -> sigma=sigma**2")
    fit_decay.mistake(
        "constant-factor",
        "the covariance is scaled by χ²/(n − p)",
        change="absolute_sigma=True -> absolute_sigma=False",
    )
    fit_decay.mistake(
        "missing-term",
        "the covariances are missing",
        change="return p, C -> return p, np.diag(np.diag(C))",
    )
    fit_decay.mistake(change="return p, C -> return p, np.sqrt(abs(C))")


@notebook.exercise("11")
def numbers_computed_in_a_cell(ask):
    """The growth rate of the spin about the middle axis, the moments, and which axis is stable."""
    to_rounding = close(rtol=1e-12, atol=0, because=a_few_roundings)
    spins = ask.cell("rate axes")
    spins.truth("rate", 3**-0.5, agree=to_rounding)
    spins.truth(
        "axes",
        [1 / 6, 1 / 3, 1 / 2],
        agree=Value(to_rounding, label="the moments are fractions of their sum"),
    )
    spins.claim(
        "growth_extreme < 0.003 < growth_middle",
        "spin is stable about the extreme axes, unstable about the middle axis",
        because="three times the nudge",
    )
    spins.mistake(
        "wrong-index",
        "the second moment stands for the third",
        change="(first * third) -> (first * second)",
    )
    spins.mistake(
        "missing-term",
        "it oscillates instead of growing",
        change="np.cosh(4 * rate) -> np.cos(4 * rate)",
    )
    spins.mistake(change=" / moments.sum() ->  / moments")


DECAY = expression("-k * y", of="t y", k=between(0.5, 2))


def growth(z):
    """Return the factor by which a step of Heun's method for y' = λy changes y, with z = λh."""
    return 1 + z + z**2 / 2


@notebook.draw
def integration(draw):
    """Return a state, a time and a number of steps."""
    return {"y": draw(array_of(2, between(-1, 1))), "T": draw(between(0.5, 2)), "n": draw(integer(4, 9))}


@notebook.exercise("12")
def an_integration_of_several_steps(ask):
    """A step of Heun's method, and what is made of it: an integration, its error, and a number."""
    heun_step = ask.function("heun_step")
    heun_step.case("", f=DECAY, t=0.0, y=array_of(2, between(-1, 1)), h=between(0.05, 0.2))

    @heun_step.truth(agree=rounding)
    def grown(k, y, h):
        return y * growth(-k * h)

    heun_step.mistake(
        "wrong-quantity",
        "this is Euler's step",
        change="h / 2 * (slope + f(t + h, y + h * slope)) -> h * slope",
    )

    integrate = ask.function("integrate", integration)
    integrate.case("", f=DECAY)

    @integrate.truth(agree=relative(1e-12, because=a_few_roundings))
    def grown_n_times(k, y, T, n):
        return y * growth(-k * T / n) ** n

    integrate.mistake("off-by-one", "the last step is missing", change="range(n) -> range(n - 1)")

    error_estimate = ask.function("error_estimate", integration)
    error_estimate.case("", f=DECAY)

    @error_estimate.truth(agree=absolute(1e-12, because=a_few_roundings))
    def third_of_the_difference(k, y, T, n):
        return y * (growth(-k * T / n / 2) ** (2 * n) - growth(-k * T / n) ** n) / 3

    error_estimate.mistake("constant-factor", "the error is divided by 4", change="/ 3 -> / 4")

    halved = ask.cell("halved")
    halved.truth("halved", 0.625, agree=close(rtol=1e-12, atol=0, because=a_few_roundings))
    halved.mistake("constant-factor", "the step is half as long", change="0.5) -> 0.25)")


def swing(x, angle):
    """Return the positions (n, 2) of a pendulum of length 1 that hangs at x."""
    return np.column_stack([x + np.sin(angle), -np.cos(angle)])


@notebook.exercise("13")
def two_coupled_pendulums(ask):
    """An animation of two bobs."""
    animate = ask.animation(
        "animate_pendulums",
        follows="a b",
        agree=at_most(0.03, because="linear interpolation between the samples deviates by a tenth of it"),
    )
    t = np.linspace(0, 6, 50)
    together, opposed = 0.35 * np.cos(2 * t), 0.35 * np.cos(2.7 * t)
    animate.case("", t=t, a=swing(-0.7, together + opposed), b=swing(0.7, together - opposed))
    animate.mistake(
        "wrong-motion",
        "a is drawn twice",
        change="b[k, 0]], [a[k, 1], b[k, 1]] -> a[k, 0]], [a[k, 1], a[k, 1]]",
    )
    animate.mistake(
        "wrong-frames",
        "the samples are not shown at an even rate",
        change="(k):\n -> (k):\n        k = k * k // len(t)\n",
    )
    animate.mistake(
        "wrong-motion",
        "b stays where it begins",
        change="b[k, 0]], [a[k, 1], b[k, 1]] -> b[0, 0]], [a[k, 1], b[0, 1]]",
    )
