"""The assignment waves: its truths against third sources, and right answers of several forms."""

import mpmath
import numpy as np
import pytest

from exercises.waves import assignment as author
from tests.support.toolbox import failed, judged

QUESTIONS = {question.function: question for question in author.notebook.questions()}


def rows(name, count=20, seed=7):
    drawn = QUESTIONS[name].draw(np.random.default_rng(seed), count)
    return [{key: value[k] for key, value in drawn.items()} for k in range(count)]


@pytest.mark.parametrize("name", ["find_root", "wave_number"])
def test_the_wave_numbers_are_those_of_sixty_digits(name):
    with mpmath.workdps(60):
        for row in rows(name):
            w, d, g = (mpmath.mpf(float(value)) for value in (row["w"], row["d"], 9.81))
            low, high = w**2 / g, w**2 / g + w / mpmath.sqrt(g * d)
            k = mpmath.findroot(
                lambda k, w=w, d=d, g=g: g * k * mpmath.tanh(k * d) - w**2, (low, high), solver="anderson", tol=1e-80
            )
            assert author.by_iteration(row["w"], row["d"]) == pytest.approx(float(k), rel=1e-13)
            assert low < k < high and 0 < k < 20, "the root is in the intervals that students are given"


def test_the_group_velocity_is_the_derivative_of_the_dispersion_relation():
    with mpmath.workdps(60):
        for row in rows("group_velocity"):
            k, d, g = (mpmath.mpf(float(value)) for value in (row["k"], row["d"], 9.81))
            wanted = mpmath.diff(lambda k, d=d, g=g: mpmath.sqrt(g * k * mpmath.tanh(k * d)), k)
            assert author.by_phase_velocity(row["k"], row["d"]) == pytest.approx(float(wanted), rel=1e-12)


def step_matrix(N, r):
    """The matrix of a step of the inner points, by its definition."""
    return 2 * np.eye(N - 1) + r**2 * (np.eye(N - 1, k=1) - 2 * np.eye(N - 1) + np.eye(N - 1, k=-1))


def test_a_step_and_a_run_are_those_of_matrices():
    for row in rows("string_step", 3):
        wanted = step_matrix(20, row["r"]) @ row["u"][1:-1] - row["before"][1:-1]
        assert author.by_modes(**row) == pytest.approx(np.pad(wanted, 1), abs=1e-13)
    for row in rows("vibrate", 3):
        A = step_matrix(20, row["r"])
        inner = [row["u"][1:-1], A @ row["u"][1:-1] / 2]
        for _ in range(59):
            inner.append(A @ inner[-1] - inner[-2])
        assert author.by_cosines(row["u"], row["r"], 60)[:, 1:-1] == pytest.approx(np.array(inner), abs=1e-12)


def test_with_r_1_the_run_is_d_alembert_s_solution():
    u = rows("vibrate", 1)[0]["u"]
    periodic = np.concatenate([u, -u[-2:0:-1]])
    wanted = [(np.roll(periodic, n) + np.roll(periodic, -n))[:21] / 2 for n in range(61)]
    assert author.by_cosines(u, 1.0, 60) == pytest.approx(np.array(wanted), abs=1e-12)


def test_the_limit_is_that_of_the_largest_eigenvalue_of_the_difference():
    for row in rows("stability_limit", 6):
        N, q = int(row["N"]), row["q"]
        D = step_matrix(N, 1.0) - 2 * np.eye(N - 1)
        largest = np.linalg.eigvalsh(-(D + q * D @ D)).max()
        assert author.by_fastest_mode(N, q) == pytest.approx(2 / np.sqrt(largest), rel=1e-12) and 0.1 < 2 / np.sqrt(largest) < 4


def test_amplitudes_spectrum_and_frequencies_have_other_definitions_that_agree():
    u = rows("modes", 1)[0]["u"]
    sums = [2 / 20 * sum(u[j] * np.sin(m * np.pi * j / 20) for j in range(21)) for m in range(1, 20)]
    assert author.by_solving(u) == pytest.approx(np.array(sums), abs=1e-13)
    t = np.arange(48) * 0.25
    frequencies, found = author.by_sums(0.5 + 3 * np.cos(2 * np.pi * t / 3 + 1) - 2 * (-1.0) ** np.arange(48), 0.25)
    assert dict(zip(frequencies.round(9), found.round(12), strict=True)).items() >= {(0.0, 0.5), (round(1 / 3, 9), 3.0), (2.0, 2.0)}
    for row in rows("frequency_ratio", 5):
        eigenvalue = np.sort(np.linalg.eigvalsh(step_matrix(int(row["N"]), row["r"])))[::-1][row["m"] - 1]
        assert author.by_eigenvalue(**row) == pytest.approx(
            np.arccos(eigenvalue / 2) / (row["r"] * row["m"] * np.pi / row["N"]), rel=1e-9
        )


BRENT = "from scipy.optimize import brentq\n    return brentq(f, a, b, xtol=tol)"
RIDDER = "from scipy import optimize\n    return optimize.root_scalar(f, bracket=[a, b], method='ridder', xtol=tol).root"
SECANT = """old, x, fold, fx = a, b, f(a), f(b)
    while abs(x - old) > tol and fx != 0:
        old, x, fold = x, x - fx * (x - old) / (fx - fold), fx
        fx = f(x)
    return x"""
NEWTON = """x = b
    for _ in range(14):
        value, h = f(x), 1e-6
        x -= value * h / (f(x + h) - value)
    return x"""
LOOPS = """N = len(u) - 1
    new = [0] * (N + 1)
    for j in range(1, N):
        new[j] = 2 * (1 - r * r) * u[j] + r * r * (u[j - 1] + u[j + 1]) - before[j]
    return new"""
CONVOLVED = "return np.pad(2 * u - before + r**2 * np.convolve(u, [1, -2, 1], 'same'), 0) * (np.arange(len(u)) % (len(u) - 1) > 0)"
WHOLE = """out = np.zeros((n + 1, len(u)))
    out[0] = u
    out[1, 1:-1] = u[1:-1] + r**2 / 2 * np.diff(u, 2)
    for k in range(1, n):
        out[k + 1, 1:-1] = 2 * out[k, 1:-1] - out[k - 1, 1:-1] + r**2 * np.diff(out[k], 2)
    return out"""
BRACKETED = """from scipy.optimize import brentq
    def excess(r):
        M = np.zeros((2 * N - 2, 2 * N - 2))
        for k in range(2 * N - 2):
            v = np.zeros(2 * N - 2)
            v[k] = 1
            u, before = np.zeros(N + 1), np.zeros(N + 1)
            u[1:N], before[1:N] = v[: N - 1], v[N - 1 :]
            M[:, k] = np.append(step(u, before, r)[1:N], u[1:N])
        return max(abs(np.linalg.eigvals(M))) - 1 - 1e-7
    return brentq(excess, 0.1, 4, xtol=1e-7)"""
ALL_POINTS = """E, Z = np.eye(N + 1), np.zeros(N + 1)
    low, high = 0.1, 4
    for _ in range(30):
        r = (low + high) / 2
        now = np.array([step(e, Z, r) for e in E[1:-1]]).T[1:-1]
        old = np.array([step(Z, e, r) for e in E[1:-1]]).T[1:-1]
        M = np.block([[now, old], [np.eye(N - 1), 0 * old]])
        low, high = (low, r) if np.abs(np.linalg.eigvals(M)).max() > 1.0000001 else (r, high)
    return low"""
SINES = "N = len(u) - 1\n    return 2 / N * np.sin(np.pi / N * np.outer(range(1, N), range(N + 1))) @ u"
DST = "from scipy.fft import dst\n    return dst(u[1:-1], type=1) / (len(u) - 1)"
WITH_FFT = """n = len(x)
    c = np.fft.fft(x)[: n // 2 + 1]
    a = [abs(c[0]) / n, *(2 * abs(c[1:-1]) / n), abs(c[-1]) / n]
    return [k / n / dt for k in range(n // 2 + 1)], a"""
QUOTIENT = """def w(k):
        return (9.81 * k * np.tanh(k * d)) ** 0.5
    return (w(k * 1.00001) - w(k * 0.99999)) / (0.00002 * k)"""
ITERATED = """k = max(w**2 / 9.81, w / (9.81 * d) ** 0.5)
    for _ in range(60):
        k -= (9.81 * k * np.tanh(k * d) - w**2) / (9.81 * (np.tanh(k * d) + k * d * (1 - np.tanh(k * d) ** 2)))
    return k"""


@pytest.mark.parametrize(
    ("name", "body"),
    [
        *(("find_root", body) for body in (BRENT, RIDDER, SECANT, NEWTON)),
        *(("wave_number", body) for body in (ITERATED,)),
        ("group_velocity", QUOTIENT),
        *(("string_step", body) for body in (LOOPS, CONVOLVED)),
        ("vibrate", WHOLE),
        *(("stability_limit", body) for body in (BRACKETED, ALL_POINTS)),
        *(("modes", body) for body in (SINES, DST)),
        ("spectrum", WITH_FFT),
        ("frequency_ratio", "return np.arccos(1 - 2 * (r * np.sin(m * np.pi / 2 / N)) ** 2) * N / (r * m * np.pi)"),
    ],
)
def test_right_answers_of_other_forms_pass(name, body):
    question = QUESTIONS[name]
    outcomes = judged(question, f"def {name}({', '.join(question.ask)}):\n    {body}\n")
    assert failed(outcomes) == set(), [outcome.line for outcome in outcomes.values()]


def test_bisection_is_right_but_needs_more_calls_than_allowed():
    body = "while b - a > tol:\n        m = (a + b) / 2\n        a, b = (m, b) if f(m) < 0 else (a, m)\n    return (a + b) / 2"
    outcomes = judged(QUESTIONS["find_root"], f"def find_root(f, a, b, tol):\n    {body}\n")
    assert failed(outcomes) == {"1-calls", "1-new-calls"} and outcomes["1-calls"].measured == 38
