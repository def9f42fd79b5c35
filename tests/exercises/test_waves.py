"""The assignment waves: its truths against third sources, and right answers of several forms."""

import mpmath
import numpy as np
import pytest

from exercises.waves import assignment as author
from polhode.judging.return_value import WrongAnswer
from polhode.kinds.student_calls import expression
from tests.support.toolbox import failed, judged

ALL = list(author.notebook.questions())
QUESTIONS = {question.function: question for question in reversed(ALL)}  # the first question of each function


def exact(name):
    """The truth of a function, of the inputs that it names."""
    return QUESTIONS[name].truth


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
                lambda k, w=w, d=d, g=g: g * k * mpmath.tanh(k * d) - w**2,
                (low, high),
                solver="anderson",
                tol=1e-80,
            )
            assert author.wave_number_by_newton(row["w"], row["d"]) == pytest.approx(float(k), rel=1e-13)
            assert low * (1 - mpmath.mpf("1e-50")) <= k < high and 0 < k < 20, (
                "the root is in the intervals that students are given"
            )


def test_the_group_velocity_is_the_derivative_of_the_dispersion_relation():
    with mpmath.workdps(60):
        for row in rows("group_velocity"):
            k, d, g = (mpmath.mpf(float(value)) for value in (row["k"], row["d"], 9.81))
            wanted = mpmath.diff(lambda k, d=d, g=g: mpmath.sqrt(g * k * mpmath.tanh(k * d)), k)
            assert exact("group_velocity")(row["k"], row["d"]) == pytest.approx(float(wanted), rel=1e-12)


def step_matrix(N, r):
    """The matrix of a step of the inner points, by its definition."""
    return 2 * np.eye(N - 1) + r**2 * (np.eye(N - 1, k=1) - 2 * np.eye(N - 1) + np.eye(N - 1, k=-1))


def test_a_step_and_a_run_are_those_of_matrices():
    for row in rows("string_step", 3):
        wanted = step_matrix(20, row["r"]) @ row["u"][1:-1] - row["before"][1:-1]
        assert exact("string_step")(row["u"], row["before"], row["r"]) == pytest.approx(
            np.pad(wanted, 1), abs=1e-13
        )
    for row in rows("vibrate", 3):
        A = step_matrix(20, row["r"])
        inner = [row["u"][1:-1], A @ row["u"][1:-1] / 2]
        for _ in range(59):
            inner.append(A @ inner[-1] - inner[-2])
        assert exact("vibrate")(row["u"], row["r"], 60)[:, 1:-1] == pytest.approx(np.array(inner), abs=1e-12)


def test_with_r_1_the_run_is_d_alembert_s_solution():
    u = rows("vibrate", 1)[0]["u"]
    periodic = np.concatenate([u, -u[-2:0:-1]])
    wanted = [(np.roll(periodic, n) + np.roll(periodic, -n))[:21] / 2 for n in range(61)]
    assert exact("vibrate")(u, 1.0, 60) == pytest.approx(np.array(wanted), abs=1e-12)


def limit_of(row):
    return exact("stability_limit")(*(row[name] for name in ("N", "q", "c", "damped", "L")))


def test_the_limit_is_that_of_the_matrix_of_the_scheme():
    limits = []
    for row in rows("stability_limit", 36):
        N, q, c = int(row["N"]), row["q"], row["c"]
        one = np.eye(N - 1)
        D = step_matrix(N, 1.0) - 2 * one

        def largest(r, one=one, D=D, q=q, c=c, row=row):
            kept = (r / row["L"]) ** 2 if row["damped"] else 1
            A = (1 + kept) * one + (r * c) ** 2 * (D + q * D @ D)
            return np.abs(np.linalg.eigvals(np.block([[A, -kept * one], [one, 0 * one]]))).max()

        limits.append(limit_of(row))
        below = [largest(r) for r in np.linspace(0.1, limits[-1] * (1 - 1e-6), 20)]
        above = [largest(r) for r in np.linspace(limits[-1] * (1 + 1e-6), 4, 20)]
        assert max(below) < 1 + 1e-7 < min(above)
    assert 0.1 < min(limits) < 0.2 and 3 < max(limits) < 4


def matrix_of(row, r):
    scheme = QUESTIONS["stability_limit"].inputs["step"]
    step = expression(scheme.text, scheme.over, {name: row[name] for name in scheme.given})
    N = int(row["N"])
    pairs = np.pad(np.eye(2 * N - 2).reshape(-1, 2, N - 1), ((0, 0), (0, 0), (1, 1)))
    return np.array([[*step(u, before, r)[1:-1], *u[1:-1]] for u, before in pairs]).T


@pytest.mark.parametrize("seed", range(4))
def test_the_steps_that_are_asked_grow_in_several_ways(seed):
    shapes, phases = set(), set()
    for row in rows("stability_limit", 6, seed):
        N = int(row["N"])
        found, vectors = np.linalg.eig(matrix_of(row, limit_of(row) * (1 + 1e-4)))
        first = np.abs(found).argmax()
        phases.add(bool(abs(found[first].imag) > 1e-6))
        changes = int(np.sum(np.diff(np.sign(vectors[: N - 1, first].real)) != 0))
        shapes.add(changes == N - 2)
    assert phases == shapes == {False, True}


def test_amplitudes_spectrum_and_frequencies_have_other_definitions_that_agree():
    u = rows("modes", 1)[0]["u"]
    sums = [2 / 20 * sum(u[j] * np.sin(m * np.pi * j / 20) for j in range(21)) for m in range(1, 20)]
    assert exact("modes")(u) == pytest.approx(np.array(sums), abs=1e-13)
    t = np.arange(48) * 0.25
    frequencies, found = exact("spectrum")(
        0.5 + 3 * np.cos(2 * np.pi * t / 3 + 1) - 2 * (-1.0) ** np.arange(48), 0.25
    )
    assert dict(zip(frequencies.round(9), found.round(12), strict=True)).items() >= {
        (0.0, 0.5),
        (round(1 / 3, 9), 3.0),
        (2.0, 2.0),
    }
    for row in rows("frequency_ratio", 5):
        eigenvalue = np.sort(np.linalg.eigvalsh(step_matrix(int(row["N"]), row["r"])))[::-1][row["m"] - 1]
        assert exact("frequency_ratio")(row["m"], row["N"], row["r"]) == pytest.approx(
            np.arccos(eigenvalue / 2) / (row["r"] * row["m"] * np.pi / row["N"]), rel=1e-9
        )


BRENT = "from scipy.optimize import brentq\n    return brentq(f, a, b, xtol=tol)"
RIDDER = (
    "from scipy import optimize\n"
    "    return optimize.root_scalar(f, bracket=[a, b], method='ridder', xtol=tol).root"
)
LOOPS = """N = len(u) - 1
    new = [0] * (N + 1)
    for j in range(1, N):
        new[j] = 2 * (1 - r * r) * u[j] + r * r * (u[j - 1] + u[j + 1]) - before[j]
    return new"""
CONVOLVED = (
    "return np.pad(2 * u - before + r**2 * np.convolve(u, [1, -2, 1], 'same'), 0) * (np.arange(len(u)) %"
    " (len(u) - 1) > 0)"
)
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
        slope = 9.81 * (np.tanh(k * d) + k * d * (1 - np.tanh(k * d) ** 2))
        k -= (9.81 * k * np.tanh(k * d) - w**2) / slope
    return k"""


@pytest.mark.parametrize(
    ("name", "body"),
    [
        *(("find_root", body) for body in (BRENT, RIDDER)),
        *(("wave_number", body) for body in (ITERATED,)),
        ("group_velocity", QUOTIENT),
        *(("string_step", body) for body in (LOOPS, CONVOLVED)),
        ("vibrate", WHOLE),
        *(("stability_limit", body) for body in (BRACKETED, ALL_POINTS)),
        *(("modes", body) for body in (SINES, DST)),
        ("spectrum", WITH_FFT),
        (
            "frequency_ratio",
            "return np.arccos(1 - 2 * (r * np.sin(m * np.pi / 2 / N)) ** 2) * N / (r * m * np.pi)",
        ),
    ],
)
def test_right_answers_of_other_forms_pass(name, body):
    for question in [question for question in ALL if question.function == name]:
        outcomes = judged(question, f"def {name}({', '.join(QUESTIONS[name].inputs)}):\n    {body}\n")
        assert failed(outcomes) == set(), [outcome.line for outcome in outcomes.values()]


UNGUARDED = """fa, fb = f(a), f(b)
    while abs(b - a) > tol:
        a, b, fa = b, b - fb * (b - a) / (fb - fa), fb
        fb = f(b)
    return b"""
CLAMPED = f"r = min(r, 1)\n    {LOOPS}"
TWENTY = "return -np.fft.rfft(np.concatenate([u, -u[-2:0:-1]])).imag[1:-1] / 20"
ZIGZAG = """s = np.sin((N - 1) * np.pi * np.arange(N + 1) / N)
    low, high = 0.1, 4
    while high - low > 1e-7:
        r = (low + high) / 2
        a, b = (step(s, 0 * s, r) @ s / (s @ s), step(0 * s, s, r) @ s / (s @ s))
        low, high = (low, r) if max(abs(np.roots([1, -a, -b]))) > 1 + 1e-7 else (r, high)
    return low"""
SMALL_VALUE = """from scipy.optimize import brentq
    def g(x):
        value = f(x)
        return 0.0 if abs(value) < tol else value
    return brentq(g, a, b, xtol=tol)"""
REAL = ALL_POINTS.replace("np.linalg.eigvals(M)", "np.linalg.eigvals(M).real")


@pytest.mark.parametrize(
    ("name", "body"),
    [
        ("find_root", SMALL_VALUE),
        ("wave_number", f"if w**2 * d > 60:\n        return w**2 / 9.81\n    {ITERATED}"),
        ("group_velocity", f"if k * d > 6:\n        return (9.81 / k) ** 0.5 / 2\n    {QUOTIENT}"),
        ("group_velocity", f"if k * d < 0.02:\n        return (9.81 * d) ** 0.5\n    {QUOTIENT}"),
        ("string_step", CLAMPED),
        (
            "string_step",
            f"u, before = (np.pad(one[:129], (0, max(0, len(u) - 129))) for one in (u, before))\n    {LOOPS}",
        ),
        ("modes", f"u = np.pad(u[:129], (0, max(0, len(u) - 129)))\n    {DST}"),
        ("modes", TWENTY),
        ("stability_limit", ZIGZAG),
        ("stability_limit", REAL),
        ("stability_limit", ALL_POINTS.replace("0.1, 4", "0.1, 2")),
        ("stability_limit", ALL_POINTS.replace("0.1, 4", "0.5, 4")),
        (
            "frequency_ratio",
            "return np.sin(m * np.pi / 2 / N) / (m * np.pi / 2 / N) if N < 10 else by_arcsin(m, N, r)",
        ),
    ],
)
def test_what_is_right_for_some_inputs_only_is_refused(name, body):
    source = f"def {name}({', '.join(QUESTIONS[name].inputs)}):\n    {body}\n"
    source += (
        "\ndef by_arcsin(m, N, r):\n"
        "    return 2 * np.arcsin(r * np.sin(m * np.pi / 2 / N)) / (r * m * np.pi / N)\n"
    )
    assert any(failed(judged(question, source)) for question in ALL if question.function == name)


def seen_in_public(question, source):
    return {id for id in failed(judged(question, source)) if "-new-" not in id}


BISECTION = """a, b = float(a), float(b)
    while b - a > {width} and abs(f((a + b) / 2)) > {value}:
        m = (a + b) / 2
        a, b = (m, b) if f(m) < 0 else (a, m)
    return (a + b) / 2"""
NEWTON = """x, h = (a + b) / 2, 1e-7 * (b - a)
    while abs(f(x)) > {value}:
        slope = (f(x + h) - f(x - h)) / (2 * h)
        lower, upper = (x, b) if f(x) < 0 else (a, x)
        a, b, x = lower, upper, x - f(x) / slope
        x = x if a < x < b else (a + b) / 2
    return x"""


@pytest.mark.parametrize("value", ["1e-8", "1e-10", "tol"])
@pytest.mark.parametrize("body", [BISECTION, NEWTON, SMALL_VALUE])
def test_a_search_that_stops_where_f_is_small_is_seen_in_public(body, value):
    source = f"def find_root(f, a, b, tol):\n    {body.format(value=value, width=0)}\n"
    source = source.replace("< tol", f"< {value}")
    assert "1-2-value" in seen_in_public(ALL[1], source)


@pytest.mark.parametrize("width", [1e-3, 1e-4, 1e-5, 5e-6])
def test_a_loose_bisection_is_seen_in_public(width):
    limit = QUESTIONS["stability_limit"]
    loose = limit.source.replace("unstable - stable > 1e-7", f"unstable - stable > {width}")
    assert seen_in_public(limit, loose) == {"5-value"}
    root = BISECTION.format(value=-1, width=1e3 * width * 1e-10)
    assert "1-1-value" not in seen_in_public(ALL[0], f"def find_root(f, a, b, tol):\n    {root}\n")
    root = BISECTION.format(value=-1, width=width)
    assert "1-1-value" in seen_in_public(ALL[0], f"def find_root(f, a, b, tol):\n    {root}\n")


SCAN = """def grows(r):
        pairs = np.eye(2 * N - 2).reshape(-1, 2, N - 1)
        columns = [np.append(step(np.pad(u, 1), np.pad(before, 1), r)[1:-1], u) for u, before in pairs]
        return np.abs(np.linalg.eigvals(np.array(columns))).max() > 1 + 1e-7
    low = 0.1
    for width in {widths}:
        while not grows(low + width):
            low += width
    return low"""


@pytest.mark.parametrize("seed", range(5))
def test_a_scan_of_thousands_is_refused_whatever_is_drawn_and_one_by_digits_is_right(seed):
    def judge(widths):
        source = f"def stability_limit(step, N):\n    {SCAN.format(widths=widths)}\n"
        return failed(judged(QUESTIONS["stability_limit"], source, seed))

    with pytest.raises(WrongAnswer, match="it called step more than 20000 times"):
        judge([0.001, 1e-4, 1e-5, 1e-6])
    assert judge([0.01, 1e-3, 1e-4, 1e-5, 1e-6]) == set()


def test_one_amplitude_is_an_array_too():
    source = f"def modes(u):\n    {SINES.replace('return', 'b =')}\n    return b if len(b) > 1 else b[0]\n"
    of_20, of_other_sizes = (question for question in ALL if question.function == "modes")
    assert failed(judged(of_20, source)) == set()
    with pytest.raises(WrongAnswer, match="what the check makes of modes's answers must be an array"):
        judged(of_other_sizes, source)


def test_an_unguarded_secant_leaves_the_interval():
    with pytest.raises(WrongAnswer, match="not finite"):
        judged(ALL[1], f"def find_root(f, a, b, tol):\n    {UNGUARDED}\n")


def test_bisection_is_right_but_needs_more_calls_than_allowed():
    body = (
        "while b - a > tol:\n        m = (a + b) / 2\n        a, b = (m, b) if f(m) < 0 else (a, m)\n"
        "    return (a + b) / 2"
    )
    outcomes = judged(QUESTIONS["find_root"], f"def find_root(f, a, b, tol):\n    {body}\n")
    assert failed(outcomes) == {"1-1-calls", "1-1-new-calls"} and outcomes["1-1-calls"].measured == 38
