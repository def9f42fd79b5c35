"""Coupled oscillators: what is asked about notebook.ipynb, which holds text, Setup and solutions.

The data of dispersion.csv are ω at q = 1/8, 2/8, … 3 for A = 47 and B = 4.6, with normal noise of numpy's
default_rng(2300).

In a mistake, ``change`` replaces one place of the notebook's solution, and a question is called as its right
solution. A mistake without words must fail, and gives no hint. ``public`` and ``hidden`` are numbers of
inputs: of fixed ones, which students have too, and of ones that are drawn for each grading.

Every truth has a second source in tests/exercises/test_coupled_oscillators.py: numbers of another method with
60 digits.
"""

from decimal import Context, Decimal

import numpy as np
from scipy.linalg import expm
from scipy.optimize import curve_fit

from exercises.authoring import (
    Notebook,
    Value,
    array_of,
    at_most,
    between,
    close,
    integer,
    relative,
    with_ends,
)

notebook = Notebook("notebook.ipynb", data=("dispersion.csv",))

rounding = relative(1e-12, because="a thousand rounding errors of the largest number")
of_modes = relative(
    1e-9,
    because="rounding errors over the smallest distance of two eigenvalues: up to 1e-13, ten thousand times",
)


@notebook.exercise("1")
def stiffness_matrix(ask):
    """The matrix of the forces of N + 1 springs on N masses between two walls."""
    chain_stiffness = ask.function("chain_stiffness")
    chain_stiffness.case("", k=array_of(3, between(0.5, 9)))

    def of_N_masses(chain_stiffness, k, N):
        """The matrix of a chain of N masses, padded with zeros so that every N gives the same shape."""
        return np.pad(chain_stiffness(k[: N + 1]), (0, 30 - N))

    chain_stiffness.case(
        "2 to 30 masses", call=of_N_masses, k=array_of(31, between(0.5, 9)), N=integer(2, 30)
    )

    @chain_stiffness.truth(agree=rounding)
    def by_incidence(k):
        """Spring j is stretched by x_j - x_(j-1): with the matrix S of these differences V = (Sx)ᵀk(Sx)/2."""
        stretch = np.eye(len(k), len(k) - 1) - np.eye(len(k), len(k) - 1, -1)
        return stretch.T @ np.diag(k) @ stretch

    @chain_stiffness.mistake("sign-flipped", "a spring pulls both of its ends the same way")
    def same_way(k):
        return np.diag(k[:-1] + k[1:]) + np.diag(k[1:-1], 1) + np.diag(k[1:-1], -1)

    chain_stiffness.mistake(
        "wrong-index",
        "both springs of a mass are taken as the one to its right",
        change="k[:-1] + k[1:] -> 2 * k[1:]",
    )

    @chain_stiffness.mistake("wrong-index", "the coupling is that of the spring behind the neighbour")
    def spring_behind_the_neighbour(k):
        return np.diag(k[:-1] + k[1:]) - np.diag(k[2:], 1) - np.diag(k[2:], -1)

    @chain_stiffness.mistake("wrong-index", "the coupling is that of the spring before both masses")
    def spring_before_both(k):
        return np.diag(k[:-1] + k[1:]) - np.diag(k[:-2], 1) - np.diag(k[:-2], -1)


def drawn_stiffness(draw, N):
    """Return a full stiffness matrix (N, N).

    Its eigenvalues are 0.5 to 13.5 at equal ratios, each times 1 to 1.2. Masses from 1 to 2 divide them by 1
    to 2: those of four masses, whose ratios are at least 2.5, keep ratios of at least 1.25; those of eight
    may come closer.
    """
    axes, _ = np.linalg.qr(draw.rng.normal(size=(N, N)))
    roots = axes * np.sqrt(np.geomspace(0.5, 13.5, N) * draw.rng.uniform(1, 1.2, N))
    return roots @ roots.T


@notebook.draw
def four_masses(draw):
    """Four masses, their stiffness, and the start of a motion, seen at eight times."""
    return {
        "m": draw(array_of(4, between(1, 2))),
        "K": drawn_stiffness(draw, 4),
        "x0": draw(array_of(4, between(-1, 1))),
        "v0": draw(array_of(4, between(-1, 1))),
        "t": np.append(0, np.cumsum(draw.rng.uniform(0.5, 3, 7))),
    }


@notebook.draw
def up_to_eight_masses(draw):
    """The same of eight masses, of which the first N are asked."""
    return {
        "N": draw(integer(2, 8)),
        "m": draw(array_of(8, between(1, 2))),
        "K": drawn_stiffness(draw, 8),
        "x0": draw(array_of(8, between(-1, 1))),
        "v0": draw(array_of(8, between(-1, 1))),
        "t": np.append(0, np.cumsum(draw.rng.uniform(0.5, 3, 7))),
    }


@notebook.exercise("2")
def modes(ask):
    """The frequencies and the modes of masses with a stiffness matrix, normalised with the masses."""
    normal_modes = ask.function("normal_modes", returns="omega X")
    normal_modes.case("", four_masses)

    def of_the_first_N(normal_modes, m, K, N):
        """Both values for the first N masses. Zeros fill them up to the size for eight masses, as the answer
        to every input has one shape.
        """
        return [np.pad(value, (0, 8 - N)) for value in normal_modes(m[:N], K[:N, :N])]

    normal_modes.case("2 to 8 masses", up_to_eight_masses, call=of_the_first_N)

    @normal_modes.truth
    def by_singular_values(m, K):
        """The eigenvalues of the symmetric, positive matrix M^(-1/2) K M^(-1/2) are its singular values, its
        singular vectors are M^(1/2) X.
        """
        U, squares, _ = np.linalg.svd(K / np.sqrt(np.outer(m, m)))
        return np.sqrt(squares[::-1]), U[:, ::-1] / np.sqrt(m)[:, None]

    normal_modes.agree(
        omega=relative(1e-11, because="ten thousand times the rounding errors of the eigenvalues"),
        X=Value(of_modes, up_to="column signs"),
    )
    normal_modes.mistake(
        "wrong-power",
        "the squares of the frequencies are returned",
        change="np.sqrt(squares) -> squares",
    )
    normal_modes.mistake("missing-term", "the masses are missing", change=", np.diag(m)) -> )")
    normal_modes.mistake(
        "transposed",
        "the modes are rows instead of columns",
        change="np.sqrt(squares), X -> np.sqrt(squares), X.T",
    )
    normal_modes.mistake(
        "normalised",
        "the columns have length 1, but XᵀMX is not 1",
        change="np.sqrt(squares), X -> np.sqrt(squares), X / np.linalg.norm(X, axis=0)",
    )
    normal_modes.mistake(
        "component-order",
        "the highest frequency comes first",
        change="np.sqrt(squares), X -> np.sqrt(squares)[::-1], X[:, ::-1]",
    )
    normal_modes.mistake(
        "units",
        "the frequencies are in Hz instead of rad/s",
        change="np.sqrt(squares) -> np.sqrt(squares) / (2 * np.pi)",
    )

    @normal_modes.mistake("component-order", "np.linalg.eig does not sort: the frequencies do not rise")
    def unsorted(m, K):
        squares, U = np.linalg.eig(K / np.sqrt(np.outer(m, m)))
        return np.sqrt(squares), U / np.sqrt(m)[:, None]


@notebook.exercise("3")
def degenerate_modes(ask):
    """The modes of a triangle of equal masses and springs: three without a force, two of one frequency, and
    one in which the triangle breathes.
    """
    triangle_modes = ask.function("triangle_modes", returns="omega rigid pair breathing")
    triangle_modes.case("", m=between(0.5, 3), k=between(1, 9))

    @triangle_modes.observe
    def by_spaces(triangle_modes, m, k):
        """The frequencies, and the columns of each frequency: only the space that they span is unique."""
        omega, X = triangle_modes(m, k)
        X = np.array(X)
        return omega, X[:, :3], X[:, 3:5], X[:, 5:]

    @triangle_modes.truth
    def by_symmetry(m, k):
        """The displacement of the corner at the angle φ, as a complex number, is constant (translations),
        ie^{iφ} (rotation), e^{−iφ} and ie^{−iφ} (the degenerate pair), or e^{iφ} (breathing).

        Breathing stretches each spring by √3: ω² = 3k/m. All ω² add up to the trace 6k/m, so each of the pair
        has 1.5k/m.
        """
        turn = np.exp(1j * np.radians([90, 210, 330]))
        fields = np.array([turn**0, 1j * turn**0, 1j * turn, turn.conj(), 1j * turn.conj(), turn])
        X = np.stack([fields.real, fields.imag], axis=-1).reshape(6, 6).T / np.sqrt(3)
        return np.sqrt(k / m * np.array([0, 0, 0, 1.5, 1.5, 3])), X[:, :3], X[:, 3:5], X[:, 5:]

    triangle_modes.agree(
        omega=Value(
            relative(1e-6, because="a rounding error of 1e-15 in ω² = 0 is 3e-8 in ω"),
            label="the frequencies of the triangle are right",
        ),
        rigid=Value(
            of_modes,
            label="columns 0 to 2 are an orthonormal basis of the motions without a force",
            up_to="span",
        ),
        pair=Value(
            of_modes,
            label="columns 3 and 4 are an orthonormal basis of the vibrations of equal frequency",
            up_to="span",
        ),
        breathing=Value(of_modes, label="column 5 is the breathing mode, of length 1", up_to="span"),
    )
    triangle_modes.mistake(
        "wrong-power",
        "the squares of the frequencies are returned",
        change="np.sqrt(np.maximum(squares, 0)) -> squares",
    )
    triangle_modes.mistake("missing-term", "the mass is missing", change="K / m -> K")
    triangle_modes.mistake(
        "sign-flipped",
        "both ends of a spring stretch it alike",
        change="stretch[j] = -stretch[i] -> stretch[j] = stretch[i]",
    )
    triangle_modes.mistake(
        "missing-term",
        "the third spring is missing",
        change="(0, 1), (1, 2), (2, 0) -> (0, 1), (1, 2)",
    )
    triangle_modes.mistake(
        "constant-factor", "the direction of a spring is not a unit vector", change=" / np.sqrt(3) -> "
    )
    triangle_modes.mistake(
        "transposed", "the modes are rows instead of columns", change=", 0)), X -> , 0)), X.T"
    )
    triangle_modes.mistake(
        "wrong-constant",
        "the corners are at 0°, 120° and 240°",
        change="[90, 210, 330] -> [0, 120, 240]",
    )
    triangle_modes.mistake(
        "normalised",
        "the columns are divided by √m, but XᵀX is to be 1",
        change=", 0)), X -> , 0)), X / np.sqrt(m)",
    )


@notebook.exercise("4")
def sum_of_modes(ask):
    """The displacements at given times, from those at t = 0 and the velocities there."""
    motion = ask.function("motion")
    motion.case("", four_masses)

    def of_the_first_N(motion, t, m, K, x0, v0, N):
        """The motion of the first N masses. Rows of zeros fill it up to eight rows, as the answer to every
        input has one shape.
        """
        return np.pad(motion(t, m[:N], K[:N, :N], x0[:N], v0[:N]), ((0, 8 - N), (0, 0)))

    motion.case("2 to 8 masses", up_to_eight_masses, call=of_the_first_N)

    @motion.truth(
        agree=relative(1e-7, because="solvers at rtol 1e-10 deviate by up to 3e-9; the sum of modes by 1e-13")
    )
    def by_matrix_exponential(t, m, K, x0, v0):
        """The state (x, v) obeys y' = Ay, so it is exp(At) times the state at t = 0."""
        A = np.block([[0 * K, np.eye(len(m))], [-K / m[:, None], 0 * K]])
        return np.array([(expm(A * at) @ [*x0, *v0])[: len(m)] for at in t]).T

    motion.mistake(
        "missing-division",
        "the velocities are not divided by ω",
        change="X.T @ (m * v0) / omega -> X.T @ (m * v0)",
    )
    motion.mistake(
        "missing-term",
        "the masses are missing: XᵀMX is 1, not XᵀX",
        change="X.T @ (m * x0), X.T @ (m * v0) -> X.T @ x0, X.T @ v0",
    )
    motion.mistake(
        "missing-term",
        "the initial velocities have no effect",
        change=" + b[:, None] * np.sin(phase) -> ",
    )


@notebook.exercise("5")
def beats(ask):
    """The time π/(ω₂ - ω₁) of two pendulums, whose modes have the frequencies ω₁ = ω₀ and ω₂ = √(ω₀² + 2κ) in
    rad/s, to a relative error of 1e-12.
    """
    beat_time = ask.function("beat_time")
    beat_time.case("", public=32, hidden=96, w0=with_ends(1, 10), kappa=with_ends(1e-12, 1, log=True))

    @beat_time.truth(
        agree=close(
            rtol=1e-12,
            atol=0,
            because="a thousand rounding errors; the difference of the frequencies loses up to 14"
            " of 16 digits",
        )
    )
    def with_60_digits(w0, kappa):
        """The difference of the frequencies itself: of 60 digits at most 14 cancel."""
        digits, w, c = Context(prec=60), Decimal(float(w0)), Decimal(float(kappa))
        difference = digits.subtract(digits.sqrt(digits.fma(w, w, 2 * c)), w)
        return float(digits.divide(Decimal("3.14159265358979323846264338327950288"), difference))

    beat_time.mistake(
        "precision-loss",
        "the two frequencies cancel in their difference",
        change="+ w0) / (2 * kappa) -> - w0) ** -1",
    )
    beat_time.mistake(
        "constant-factor",
        "twice the time: the energy is back at the first pendulum, not at the second",
        change="np.pi * -> 2 * np.pi *",
    )
    beat_time.mistake(
        "constant-factor",
        "ω₂² is ω₀² + 2κ, not ω₀² + κ",
        change="w0**2 + 2 * kappa -> w0**2 + kappa",
    )
    beat_time.mistake(
        "missing-term",
        "this is the limit of weak coupling",
        change="(np.sqrt(w0**2 + 2 * kappa) + w0) -> 2 * w0",
    )


def frequency_by_neighbours(q, A, B):
    """Return the frequency of the wave exp(iqn).

    The force of its first and second neighbours on mass 0 is the sum of c (exp(iqn) - 1) times the mass, and
    equals -ω² times the mass: A and B, the values of c, are force constants over the mass, in rad²/ps².
    """
    neighbours = [(1, A), (-1, A), (2, B), (-2, B)]
    return np.sqrt(sum(-c * (np.exp(1j * n * q) - 1).real for n, c in neighbours))


@notebook.exercise("6")
def waves_on_a_chain(ask):
    """The frequencies of waves on a chain with second neighbours, and on a chain of two kinds of masses."""
    chain_frequency = ask.function("chain_frequency")
    chain_frequency.case("", q=array_of(5, between(0.1, 6.2)), A=between(30, 60), B=between(1, 9))
    chain_frequency.truth(frequency_by_neighbours, agree=rounding)
    chain_frequency.mistake(
        "wrong-constant", "second neighbours are taken as first ones", change="np.sin(q) -> np.sin(q / 2)"
    )
    chain_frequency.mistake("constant-factor", "the frequencies are halved", change="2 * np.sqrt -> np.sqrt")

    @chain_frequency.mistake("wrong-power", "the sines are not squared")
    def sines_not_squared(q, A, B):
        return 2 * np.sqrt(np.abs(A * np.sin(q / 2) + B * np.sin(q)))

    branches = ask.function("branches", returns="acoustic optical")
    branches.case(
        "",
        q=array_of(5, between(0.05, 2)),
        d=between(0.5, 1.5),
        C=between(1, 9),
        m=between(0.5, 2),
        M=between(0.5, 2),
    )

    @branches.truth(
        agree=relative(
            1e-10,
            because="rounding errors of 1e-16 in ω², which the difference at small q makes 1e-13 in ω",
        )
    )
    def by_the_matrix_of_a_cell(q, d, C, m, M):
        """Each mass is joined to two of the other kind, at the phases qd and -qd, which add up to 2 cos(qd):
        ω² are the eigenvalues of a 2×2 matrix.
        """
        link = -2 * C * np.cos(q * d) / np.sqrt(m * M)
        squares = [np.linalg.eigvalsh([[2 * C / m, one], [one, 2 * C / M]]) for one in link]
        return tuple(np.sqrt(squares).T)

    branches.mistake(
        "constant-factor",
        "d is taken as the length of the cell, which is 2d",
        change="q * d -> q * d / 2",
    )
    branches.mistake(
        "component-order",
        "the optical branch comes first",
        change="np.sqrt(C * (total - root)), np.sqrt(C * (total + root))"
        " -> np.sqrt(C * (total + root)), np.sqrt(C * (total - root))",
    )
    branches.mistake(
        "constant-factor",
        "the factor 4 below the inner root is missing",
        change="4 * np.sin -> np.sin",
    )
    branches.mistake("wrong-power", "the sine is not squared", change="np.sin(q * d) ** 2 -> np.sin(q * d)")


@notebook.exercise("7")
def measured_dispersion(ask):
    """The fit of A and B to measured frequencies, with their covariance, and the speed of sound that follows
    for the file.
    """
    # number and errors of the data differ from the file's, so that neither can be written into the function
    near = at_most(
        1e-3,
        because="of a standard deviation, in the covariance of σᵢσⱼ: ten times what a fit with default"
        " options deviates",
    )
    fit_dispersion = ask.fit(
        "fit_dispersion",
        frequency_by_neighbours,
        x=np.linspace(0.1, 3.1, 40),
        sigma=np.linspace(0.2, 0.05, 40),
        drawn={"A": between(30, 60), "B": between(2, 9)},
        parameters=near,
        covariance=near,
    )
    fit_dispersion.mistake(
        "missing-term",
        "the errors of the data are not used",
        change=", sigma=sigma, absolute_sigma=True -> ",
    )
    fit_dispersion.mistake(
        "constant-factor",
        "the covariance is scaled by χ²/(n − p)",
        change="absolute_sigma=True -> absolute_sigma=False",
    )
    fit_dispersion.mistake("wrong-power", "the weights are 1/σ⁴", change="sigma=sigma -> sigma=sigma**2")

    @fit_dispersion.mistake("component-order", "the order is (B, A)")
    def second_neighbours_first(q, omega, sigma):
        exchanged = lambda q, B, A: 2 * np.sqrt(A * np.sin(q / 2) ** 2 + B * np.sin(q) ** 2)  # noqa: E731
        return curve_fit(exchanged, q, omega, sigma=sigma, absolute_sigma=True)

    of_file = ask.cell("best chi2 speed speed_error")
    found = close(rtol=1e-4, atol=0, because="A, B and speed have standard deviations of 1 %, 7 % and 0.7 %")
    # best by Newton's method with 60 digits, see the test; speed = √(A + 4B) distances per ps, with its error
    # from the covariance
    of_file.truth("best", np.array([47.2362308548995, 4.34999608744723]), agree=found)
    of_file.truth("chi2", 22.8223017395236, agree=found)
    of_file.truth("speed", 8.03966511769542, agree=found)
    of_file.truth("speed_error", 0.0544222058199531, agree=found)
    of_file.mistake(
        "constant-factor",
        "second neighbours are two distances away",
        change="best[0] + 4 * best[1] -> best[0] + best[1]",
    )
    of_file.mistake(
        "missing-term",
        "A and B are taken as independent",
        change="slope @ covariance @ slope -> slope**2 @ np.diag(covariance)",
    )
    of_file.mistake(
        "missing-division",
        "the residuals are not divided by their errors",
        change=" / sigma_data) ** 2) -> ) ** 2)",
    )
    of_file.mistake(
        "wrong-quantity",
        "χ² is divided by the degrees of freedom",
        change="_data) ** 2) -> _data) ** 2) / (len(q_data) - 2)",
    )
    # the numbers from which the data were made
    of_file.mistake(
        change="= fit_dispersion(q_data, omega_data, sigma_data)"
        " -> = [47.0, 4.6], fit_dispersion(q_data, omega_data, sigma_data)[1]"
    )
