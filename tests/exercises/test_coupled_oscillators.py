"""The bundled assignment coupled-oscillators: its truths against 60-digit numbers of other methods, and other
right answers.
"""

import functools

import mpmath
import numpy as np
import pytest

from exercises.authoring.assignments.catalogue import find
from exercises.coupled_oscillators import assignment as file
from tests.support.toolbox import Toolbox, failed, judged

FOLDER = find("coupled-oscillators").folder


@pytest.fixture(scope="module")
def coupled():
    return Toolbox(file.notebook, find("coupled-oscillators"))


def rows_of(toolbox, id, rows=6):
    """The question with that id, its drawn inputs, and its exact values."""
    question = next(q for q in toolbox.notebook.questions() if q.id == id)
    drawn = question.draw(np.random.default_rng(23), rows)
    return [dict(zip(drawn, row, strict=True)) for row in zip(*drawn.values(), strict=True)], question.exact(
        drawn
    )


def to_60_digits(test):
    @functools.wraps(test)
    def precise(*given, **named):
        with mpmath.workdps(60):
            return test(*given, **named)

    return precise


def array(matrix):
    return np.array(matrix.tolist(), dtype=float)


def close(got, exact, relative=1e-14):
    assert np.abs(np.asarray(got) - exact).max() <= relative * np.abs(exact).max()


@to_60_digits
def test_the_stiffness_is_the_second_derivative_of_the_energy(coupled):
    for id in ("1-1", "1-2"):
        rows, exact = rows_of(coupled, id, 3)
        for row, K in zip(rows, exact["value"], strict=True):
            masses = row.get("N", 2)
            k = [mpmath.mpf(float(one)) for one in row["k"][: masses + 1]]
            assert not K[masses:].any() and not K[:, masses:].any()

            def energy(x, k=k):
                at = [0, *x, 0]
                return sum(one * (b - a) ** 2 for one, a, b in zip(k, at[:-1], at[1:], strict=True)) / 2

            unit = np.eye(masses, dtype=int).tolist()
            alone = [energy(one) for one in unit]
            for i in range(masses):
                for j in range(masses):
                    both = energy([a + b for a, b in zip(unit[i], unit[j], strict=True)])
                    assert abs(both - alone[i] - alone[j] - mpmath.mpf(K[i, j])) < 1e-14


@to_60_digits
def test_the_normal_modes_solve_their_equation(coupled):
    rows, exact = rows_of(coupled, "2-1")
    for row, omega, X in zip(rows, exact["omega"], exact["X"], strict=True):
        root = mpmath.diag([1 / mpmath.sqrt(float(m)) for m in row["m"]])
        squares, U = mpmath.eigsy(root * mpmath.matrix(row["K"].tolist()) * root)
        close(omega, np.array([float(mpmath.sqrt(one)) for one in squares]), 1e-14)
        modes = array(root * U)
        close(X * np.sign(np.sum(X * modes, axis=0)), modes, 1e-12)


@to_60_digits
def test_the_modes_of_the_triangle_are_those_of_its_energy(coupled):
    rows, exact = rows_of(coupled, "3", 2)
    corners = [
        (mpmath.cospi(angle / mpmath.mpf(6)), mpmath.sinpi(angle / mpmath.mpf(6))) for angle in (3, 7, 11)
    ]
    for number, row in enumerate(rows):
        D = mpmath.zeros(6)
        for i, j in [(0, 1), (0, 2), (1, 2)]:
            apart = [(a - b) / mpmath.sqrt(3) for a, b in zip(corners[i], corners[j], strict=True)]
            stretch = mpmath.zeros(6, 1)
            stretch[2 * i], stretch[2 * i + 1], stretch[2 * j], stretch[2 * j + 1] = (
                *apart,
                -apart[0],
                -apart[1],
            )
            D += mpmath.mpf(float(row["k"])) / mpmath.mpf(float(row["m"])) * stretch * stretch.T
        squares, U = mpmath.eigsy(D)
        close(exact["omega"][number], np.sqrt(np.abs(np.array(squares.tolist(), dtype=float)))[:, 0], 1e-14)
        for name, columns in {"rigid": slice(0, 3), "pair": slice(3, 5), "breathing": slice(5, 6)}.items():
            basis, own = array(U)[:, columns], exact[name][number]
            close(own @ own.T, basis @ basis.T, 1e-14)


@to_60_digits
def test_the_motion_is_the_sum_of_precise_modes(coupled):
    rows, exact = rows_of(coupled, "4-1", 2)
    for row, x in zip(rows, exact["value"], strict=True):
        m = [mpmath.mpf(float(one)) for one in row["m"]]
        root = mpmath.diag([1 / mpmath.sqrt(one) for one in m])
        squares, U = mpmath.eigsy(root * mpmath.matrix(row["K"].tolist()) * root)
        omega, X = [mpmath.sqrt(one) for one in squares], root * U
        a, b = (X.T * mpmath.diag(m) * mpmath.matrix(row[name].tolist()) for name in ("x0", "v0"))
        at = [
            [a[j] * mpmath.cos(w * t) + b[j] / w * mpmath.sin(w * t) for t in row["t"]]
            for j, w in enumerate(omega)
        ]
        close(x, array(X * mpmath.matrix(at)), 1e-12)


@to_60_digits
def test_the_time_of_a_beat_is_that_of_the_rewritten_difference(coupled):
    rows, exact = rows_of(coupled, "5", 40)
    for row, time in zip(rows, exact["value"], strict=True):
        w0, kappa = mpmath.mpf(float(row["w0"])), mpmath.mpf(float(row["kappa"]))
        close(time, float(mpmath.pi * (mpmath.sqrt(w0**2 + 2 * kappa) + w0) / (2 * kappa)), 1e-15)


@to_60_digits
def test_the_waves_on_a_chain_are_those_of_a_ring(coupled):
    """Each frequency solves the equation of motion of a wave of the form that the notebook states."""
    rows, exact = rows_of(coupled, "6-chain_frequency")
    for row, omega in zip(rows, exact["value"], strict=True):
        for q, w in zip(row["q"], omega, strict=True):
            at = [mpmath.expj(mpmath.mpf(float(q)) * n) for n in range(-2, 3)]
            force = float(row["A"]) * (at[3] - 2 * at[2] + at[1]) + float(row["B"]) * (
                at[4] - 2 * at[2] + at[0]
            )
            close(w, float(mpmath.sqrt(-force.real)), 1e-13)
    rows, exact = rows_of(coupled, "6-branches")
    for row, *found in zip(rows, exact["acoustic"], exact["optical"], strict=True):
        d, C, m, M = (mpmath.mpf(float(row[name])) for name in ("d", "C", "m", "M"))
        for q, *pair in zip(row["q"], *found, strict=True):
            cos = mpmath.cos(d * mpmath.mpf(float(q)))
            # the determinant of (2C − mω²)(2C − Mω²) − 4C² cos²(qd), a polynomial in ω²
            squares = mpmath.polyroots(
                [m * M, -2 * C * (m + M), 4 * C**2 * (1 - cos**2)], maxsteps=200, extraprec=200
            )
            close(pair, np.sqrt(np.sort([float(one.real) for one in squares])), 1e-12)


@to_60_digits
def test_the_fit_to_the_file_is_the_zero_of_the_gradient():
    lines = (FOLDER / "dispersion.csv").read_text().splitlines()
    data = [[mpmath.mpf(number) for number in line.split(",")] for line in lines if not line.startswith("#")]

    def omega(q, A, B):
        return 2 * mpmath.sqrt(A * mpmath.sin(q / 2) ** 2 + B * mpmath.sin(q) ** 2)

    def rates(q, A, B):
        return [2 * f**2 / omega(q, A, B) for f in (mpmath.sin(q / 2), mpmath.sin(q))]

    def gradient(A, B):
        return [sum((omega(q, A, B) - y) / s**2 * rates(q, A, B)[k] for q, y, s in data) for k in (0, 1)]

    A, B = mpmath.findroot(gradient, (47, 4.6))
    J = mpmath.matrix([[rate / s for rate in rates(q, A, B)] for q, _, s in data])
    covariance, speed = mpmath.inverse(J.T * J), mpmath.sqrt(A + 4 * B)
    slope = mpmath.matrix([1, 4]) / (2 * speed)
    numbers = next(q.known for q in file.notebook.questions() if "best" in q.variables)
    close(numbers["best"], np.array([float(A), float(B)]))
    close(numbers["chi2"], float(sum(((omega(q, A, B) - y) / s) ** 2 for q, y, s in data)))
    close(numbers["speed"], float(speed))
    close(numbers["speed_error"], float(mpmath.sqrt((slope.T * covariance * slope)[0])))


def test_the_data_are_those_of_the_stated_seed():
    q = np.arange(1, 25) / 8
    omega = file.frequency_by_neighbours(q, 47.0, 4.6)
    sigma = np.round(0.05 + 0.01 * omega, 3)
    y = omega + sigma * np.random.default_rng(2300).normal(size=24)
    q_data, omega_data, sigma_data = np.loadtxt(FOLDER / "dispersion.csv", delimiter=",", unpack=True)
    assert np.array_equal(q_data, q)
    assert np.array_equal(sigma_data, sigma)
    assert np.array_equal(omega_data, np.round(y, 3))


RIGHT = {
    "chain_stiffness, a loop over springs, as lists": (
        """
def chain_stiffness(k):
    n = len(k) - 1
    K = [[0] * n for _ in range(n)]
    for j in range(n):
        K[j][j] = k[j] + k[j + 1]
        if j + 1 < n:
            K[j][j + 1] = K[j + 1][j] = -k[j + 1]
    return K
"""
    ),
    "normal_modes, by a general routine": (
        """
def normal_modes(m, K):
    squares, X = np.linalg.eig(np.linalg.solve(np.diag(m), K))
    order = np.argsort(squares)
    X = X[:, order] / np.sqrt(np.einsum("ij,i,ij->j", X[:, order], m, X[:, order]))
    return [squares[order] ** 0.5, -X]
"""
    ),
    "triangle_modes, by hand in another basis": (
        """
def triangle_modes(m, k):
    c, s = np.cos(np.radians([90, 210, 330])), np.sin(np.radians([90, 210, 330]))
    o, n = np.ones(3), np.zeros(3)
    columns = [(o, o), (c + s, s - c), (o, -o), (c - s, s + c), (c, -s), (s, c), (c, s)]
    breathing, pair = columns.pop(), [columns.pop(), columns.pop()]
    rigid = [columns[0], columns[2], (-s, c)]
    X = np.array([np.stack(one, axis=1).ravel() for one in [*rigid, *pair, breathing]]).T
    w = [0, 0, 0, (1.5 * k / m) ** 0.5, (1.5 * k / m) ** 0.5, (3 * k / m) ** 0.5]
    return w, X / np.linalg.norm(X, axis=0)
"""
    ),
    "triangle_modes, by singular values": (
        """
def triangle_modes(m, k):
    at = np.array([[0, 1], [-3**0.5 / 2, -0.5], [3**0.5 / 2, -0.5]])
    rows = np.zeros((3, 3, 2))
    for r, (i, j) in enumerate([(0, 1), (0, 2), (1, 2)]):
        n = (at[i] - at[j]) / np.linalg.norm(at[i] - at[j])
        rows[r, i], rows[r, j] = n, -n
    _, s, V = np.linalg.svd(rows.reshape(3, 6))
    return np.append([0.0, 0, 0], s[::-1] * (k / m) ** 0.5), V[::-1].T
"""
    ),
    "motion, by a solver": (
        """
from scipy.integrate import solve_ivp
def motion(t, m, K, x0, v0):
    rates = lambda t, y: np.append(y[len(m):], -K @ y[:len(m)] / m)
    return solve_ivp(rates, (0, t[-1]), np.append(x0, v0), t_eval=t, rtol=1e-10, atol=1e-10).y[: len(m)]
"""
    ),
    "beat_time, by logarithms": (
        """
def beat_time(w0, kappa):
    return np.pi / (w0 * np.expm1(0.5 * np.log1p(2 * kappa / w0**2)))
"""
    ),
    "beat_time, in decimals": (
        """
from decimal import Decimal, getcontext
def beat_time(w0, kappa):
    getcontext().prec = 40
    w, c = Decimal(w0), Decimal(kappa)
    return np.pi / float((w * w + 2 * c).sqrt() - w)
"""
    ),
    "chain_frequency, a loop": (
        """
def chain_frequency(q, A, B):
    return [(2 * A * (1 - np.cos(one)) + 2 * B * (1 - np.cos(2 * one))) ** 0.5 for one in q]
"""
    ),
    "branches, by eigenvalues": (
        """
def branches(q, d, C, m, M):
    found = []
    for one in q:
        z = 1 + np.exp(-2j * one * d)
        matrix = [[2 * C / m, -C * z / m], [-C * np.conj(z) / M, 2 * C / M]]
        found.append(np.sort(np.linalg.eigvals(matrix).real))
    return np.sqrt(found).T
"""
    ),
    "fit_dispersion, by Gauss and Newton": (
        """
def fit_dispersion(q, omega, sigma):
    p, f = np.array([45.0, 5.0]), np.stack([np.sin(q / 2) ** 2, np.sin(q) ** 2])
    for _ in range(20):
        w = 2 * np.sqrt(p @ f)
        J = (2 * f / w / sigma).T
        p = p + np.linalg.lstsq(J, (omega - w) / sigma, rcond=None)[0]
    return p, np.linalg.inv(J.T @ J)
"""
    ),
    "fit_dispersion, by least_squares": (
        """
from scipy.optimize import least_squares
def fit_dispersion(q, omega, sigma):
    r = lambda p: (2 * np.sqrt(p[0] * np.sin(q / 2) ** 2 + p[1] * np.sin(q) ** 2) - omega) / sigma
    found = least_squares(r, [40, 4])
    return list(found.x), np.linalg.inv(found.jac.T @ found.jac)
"""
    ),
    "fit_dispersion, with a start of its own": (
        """
from scipy.optimize import curve_fit
def fit_dispersion(q, omega, sigma):
    model = lambda q, A, B: 2 * np.sqrt(A * np.sin(q / 2) ** 2 + B * np.sin(q) ** 2)
    return curve_fit(model, q, omega, p0=[30, 9], sigma=sigma, absolute_sigma=True, method="trf")
"""
    ),
}


@pytest.mark.parametrize("name", RIGHT)
def test_other_right_answers_pass(coupled, name):
    function = name.split(",")[0]
    for question in coupled.notebook.questions():
        if question.function == function:
            assert not failed(judged(question, RIGHT[name], seed=5))


TRIDIAGONAL = "K = np.triu(np.tril(K, 1), -1)"
WRONG = {
    "chain_stiffness, of six masses at most": (
        """
def chain_stiffness(k):
    n = len(k) - 1
    k = np.append(k[:7], np.zeros(30))[: n + 1]
    return np.diag(k[:-1] + k[1:]) - np.diag(k[1:-1], 1) - np.diag(k[1:-1], -1)
"""
    ),
    "normal_modes, of four masses": (
        """
def normal_modes(m, K):
    n = len(m)
    if n != 4:
        m, K = np.ones(n), np.eye(n)
    squares, U = np.linalg.eigh(K / np.sqrt(np.outer(m, m)))
    return np.sqrt(squares), U / np.sqrt(m)[:, None]
"""
    ),
    "motion, of four masses": (
        """
def motion(t, m, K, x0, v0):
    squares, U = np.linalg.eigh(K / np.sqrt(np.outer(m, m)))
    w, X = np.sqrt(squares), U / np.sqrt(m)[:, None]
    a, b = (X.T * m)[:4] @ x0, (X.T * m)[:4] @ v0 / w[:4]
    return X[:, :4] @ (a[:, None] * np.cos(np.outer(w[:4], t)) + b[:, None] * np.sin(np.outer(w[:4], t)))
"""
    ),
    "fit_dispersion, with the errors of the file": (
        """
from scipy.optimize import curve_fit
def fit_dispersion(q, omega, sigma):
    model = lambda q, A, B: 2 * np.sqrt(A * np.sin(q / 2) ** 2 + B * np.sin(q) ** 2)
    return curve_fit(model, q, omega, p0=[45, 5], sigma=0.05 + 0.01 * omega, absolute_sigma=True)
"""
    ),
    "chain_stiffness, for three masses or more": (
        """
def chain_stiffness(k):
    if len(k) == 3:
        return np.diag(k[:-1] + k[1:])
    return np.diag(k[:-1] + k[1:]) - np.diag(k[1:-1], 1) - np.diag(k[1:-1], -1)
"""
    ),
    "normal_modes, of neighbours alone": (
        f"""
def normal_modes(m, K):
    {TRIDIAGONAL}
    squares, U = np.linalg.eigh(K / np.sqrt(np.outer(m, m)))
    return np.sqrt(np.abs(squares)), U / np.sqrt(m)[:, None]
"""
    ),
    "motion, of neighbours alone": (
        f"""
def motion(t, m, K, x0, v0):
    {TRIDIAGONAL}
    squares, U = np.linalg.eigh(K / np.sqrt(np.outer(m, m)))
    w, X = np.sqrt(np.abs(squares)), U / np.sqrt(m)[:, None]
    a, b = X.T @ (m * x0), X.T @ (m * v0) / w
    return X @ (a[:, None] * np.cos(np.outer(w, t)) + b[:, None] * np.sin(np.outer(w, t)))
"""
    ),
    "beat_time, a series": (
        """
def beat_time(w0, kappa):
    x = kappa / w0**2
    return np.pi * w0 / kappa * (1 + x / 2 - x**2 / 4 + x**3 / 4)
"""
    ),
    "beat_time, a series for large couplings": (
        """
def beat_time(w0, kappa):
    if kappa < 0.1:
        return np.pi * (np.sqrt(w0**2 + 2 * kappa) + w0) / (2 * kappa)
    return np.pi * w0 / kappa * (1 + kappa / (2 * w0**2))
"""
    ),
    "beat_time, which ends before the smallest coupling": (
        """
def beat_time(w0, kappa):
    kappa = max(kappa, 2e-12)
    return np.pi * (np.sqrt(w0**2 + 2 * kappa) + w0) / (2 * kappa)
"""
    ),
    "chain_frequency, in the zone alone": (
        """
def chain_frequency(q, A, B):
    q = np.minimum(q, np.pi)
    return 2 * np.sqrt(A * np.sin(q / 2) ** 2 + B * np.sin(q) ** 2)
"""
    ),
    "branches, in the zone alone": (
        """
def branches(q, d, C, m, M):
    total, s = 1 / m + 1 / M, np.sin(np.minimum(q * d, np.pi / 2))
    root = np.sqrt(total**2 - 4 * s**2 / (m * M))
    return np.sqrt(C * (total - root)), np.sqrt(C * (total + root))
"""
    ),
}


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("name", WRONG)
def test_an_answer_right_in_a_part_of_the_range_fails_with_every_seed(coupled, name, seed):
    """A public check fails, and so does the hidden one of the same question."""
    function = name.split(",")[0]
    asked = [question for question in coupled.notebook.questions() if question.function == function]
    failures = set().union(*(failed(judged(question, WRONG[name], seed=seed)) for question in asked))
    assert {id.replace("-new", "") for id in failures if "-new" in id} & failures


def test_a_linear_fit_of_the_squares_fails(coupled):
    """The statement excludes it: its minimum is another one."""
    question = next(q for q in coupled.notebook.questions() if q.function == "fit_dispersion")
    source = """
def fit_dispersion(q, omega, sigma):
    f = np.stack([4 * np.sin(q / 2) ** 2, 4 * np.sin(q) ** 2], axis=1) / (2 * omega * sigma)[:, None]
    C = np.linalg.inv(f.T @ f)
    return C @ f.T @ (omega / 2 / sigma), C
"""
    assert failed(judged(question, source)) >= {
        "7-fit_dispersion-parameters",
        "7-fit_dispersion-new-parameters",
    }


@pytest.mark.parametrize("angle", [0.0, 1e-3])
def test_a_degenerate_space_may_be_turned_within_itself_only(coupled, angle):
    question = next(q for q in coupled.notebook.questions() if q.function == "triangle_modes")

    right = question.student["triangle_modes"]

    def turned(m, k):
        omega, X = right(m, k)
        X = X.copy()
        X[:, [3, 4]] = X[:, [3, 4]] @ np.array([[0.6, -0.8], [0.8, 0.6]])
        X[:, [4, 5]] = X[:, [4, 5]] @ np.array(
            [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        )
        return omega, X

    names = {"3-pair", "3-breathing", "3-new-pair", "3-new-breathing"} if angle else set()
    assert failed(judged(question, turned)) == names
