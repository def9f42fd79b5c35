"""SciPy's integrator DOP853 for right-hand sides in Python: its coefficients and arithmetic, so the same
digits, without the wrappers around each call, which cost more than most students' functions.
"""

import functools
import math
import operator
from collections.abc import Callable
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Evaluate = Callable[[float], None]
Rates = Callable[[Array, Array], Evaluate]
"""Takes two arrays (n,) and returns a function of t that writes the rates into the second; the first then
holds the state.
"""
Stages = list[tuple[Callable[[Array, Array], Array], Array, float, Evaluate]]
"""Of each stage the product of the rates before it with weights (s,), these, its time as a share of the step,
its evaluation.
"""

MAIN, ALL = 12, 16  # stages of a step, and with those of its interpolation
SAFETY, LEAST_FACTOR, MOST_FACTOR, EXPONENT = 0.9, 0.2, 10.0, -1 / 8
STOPPED = "Required step size is less than spacing between numbers."


class IntegrationStopped(ArithmeticError):
    """The steps became too small. ``last`` is the last of the times that was reached, 0 if none was."""

    def __init__(self, last: float) -> None:
        super().__init__(STOPPED)
        self.last = last


class Tableau(NamedTuple):
    """The coefficients of DOP853: of its stages (``A``, ``C``) and weights ``B``, its two error estimates
    (``E3``, ``E5``), the stages of its interpolation (``A_extra``, ``C_extra``) and their weights ``D``.
    """

    A: Array
    C: Array
    B: Array
    E3: Array
    E5: Array
    A_extra: Array
    C_extra: Array
    D: Array


@functools.cache
def tableau() -> Tableau:
    """Return SciPy's coefficients, from their module alone if it is there: importing ``scipy.integrate``
    takes 0.3 s.
    """
    scipy = find_spec("scipy")
    file = Path(str(scipy and scipy.origin)).parent / "integrate/_ivp/dop853_coefficients.py"
    if file.is_file() and (spec := spec_from_file_location("dop853_coefficients", file)) and spec.loader:
        coefficients = module_from_spec(spec)
        spec.loader.exec_module(coefficients)
        A, C, B, E3, E5, D = operator.attrgetter("A", "C", "B", "E3", "E5", "D")(coefficients)
        return Tableau(A[:MAIN, :MAIN], C[:MAIN], B, E3, E5, A[MAIN + 1 :], C[MAIN + 1 :], D)
    from scipy.integrate import DOP853

    return Tableau(
        DOP853.A, DOP853.C, DOP853.B, DOP853.E3, DOP853.E5, DOP853.A_EXTRA, DOP853.C_EXTRA, DOP853.D
    )


@functools.cache
def solve_ivp() -> Any:
    """Return SciPy's function, imported at the first call."""
    from scipy import integrate

    return integrate.solve_ivp


def integrate(rates: Rates, start: ArrayLike, times: ArrayLike, rtol: float, atol: Array | float) -> Array:
    """Return the states (n, m) at increasing ``times`` (m,), m > 1, from the state ``start`` (n,) at the
    first of them.

    The numbers are those of ``solve_ivp(…, method="DOP853", t_eval=times)``, to the last bit. Raises
    IntegrationStopped, and what ``rates`` raises.
    """
    method = tableau()
    y, at = np.array(start, dtype=float), np.asarray(times, dtype=float)
    t, end, n = float(at[0]), float(at[-1]), len(y)
    K, state, pieces, done = np.empty((ALL, n)), y.copy(), [], 0
    bound = [rates(state, place) for place in K]
    stages = _stages(K, bound, 1, method.A[1:], method.C[1:])
    extra = _stages(K, bound, MAIN + 1, method.A_extra, method.C_extra)
    before_last, upto_last, last = K[:MAIN].T, K[: MAIN + 1].T, K[MAIN]
    bound[0](t)
    size = _first_step(bound[1], state, K, (t, end), atol + np.abs(y) * rtol)
    while t < end:
        least, rejected, weight = 10 * abs(math.nextafter(t, math.inf) - t), False, np.abs(y)
        size = max(size, least)
        while True:
            if not size >= least:  # or it is not a number
                raise IntegrationStopped(float(at[done - 1]) if done else 0.0)
            new_t = min(t + size, end)
            h = size = new_t - t
            _evaluate(stages, state, t, y, h)
            new_y = y + h * before_last.dot(method.B)
            state[:] = new_y
            bound[MAIN](t + h)
            error = _error_norm(upto_last, h, atol + np.maximum(weight, np.abs(new_y)) * rtol)
            factor = SAFETY * error**EXPONENT if error else MOST_FACTOR
            if error < 1:
                size *= float(min(1.0 if rejected else MOST_FACTOR, factor))
                break
            size *= float(max(LEAST_FACTOR, factor))
            rejected = True
        upto = int(at.searchsorted(new_t, side="right"))
        if upto > done:
            _evaluate(extra, state, t, y, h)
            pieces.append((_terms(K, h, y, new_y), (at[done:upto] - t) / h))
            done = upto
        t, y = new_t, new_y
        K[0] = last
    return _between(pieces)


def returning(rates: Rates) -> Callable[[float, Array], Array]:
    """Return a right-hand side in the form for ``solve_ivp``."""

    def returned(t: float, y: Array) -> Array:
        out = np.empty(len(y))
        rates(y, out)(t)
        return out

    return returned


def _stages(K: Array, bound: list[Evaluate], first: int, rows: Array, shares: Array) -> Stages:
    numbered = enumerate(zip(rows, shares, strict=True), start=first)
    return [(K[:s].T.dot, row[:s], float(c), bound[s]) for s, (row, c) in numbered]


def _evaluate(stages: Stages, state: Array, t: float, y: Array, h: float) -> None:
    step = np.full(len(y), h)  # multiplying by a number takes twice the time
    for product, weights, c, evaluate in stages:
        product(weights, state)
        state *= step
        state += y
        evaluate(t + c * h)


def _first_step(evaluate: Evaluate, state: Array, K: Array, span: tuple[float, float], scale: Array) -> float:
    """Return the size of the first step after Hairer, Nørsett and Wanner, Solving ODEs I, II.4."""
    (t, end), f, f1 = span, K[0], K[1]
    d0, d1 = _norm(state / scale), _norm(f / scale)
    h0 = min(1e-6 if d0 < 1e-5 or d1 < 1e-5 else 0.01 * d0 / d1, end - t)
    state += h0 * f
    evaluate(float(t + h0))
    d2 = _norm((f1 - f) / scale) / h0
    h1 = max(1e-6, h0 * 1e-3) if d1 <= 1e-15 and d2 <= 1e-15 else (0.01 / max(d1, d2)) ** -EXPONENT
    return float(min(100 * h0, h1, end - t))


def _norm(x: Array) -> Any:
    return np.linalg.norm(x) / x.size**0.5


def _error_norm(K: Array, h: float, scale: Array) -> Any:
    fifth, third = K.dot(tableau().E5), K.dot(tableau().E3)
    fifth /= scale
    third /= scale
    a, b = np.sqrt(fifth.dot(fifth)) ** 2, np.sqrt(third.dot(third)) ** 2
    return h * a / np.sqrt((a + 0.01 * b) * len(scale)) if a or b else a


def _terms(K: Array, h: float, y: Array, new_y: Array) -> Array:
    """Return the state ``y`` (n,) at the start of a step and the terms of its interpolation, highest order
    first (8, n).
    """
    terms, step = np.empty((8, len(y))), new_y - y
    terms[0] = y
    terms[7], terms[6], terms[5] = step, h * K[0] - step, 2 * step - h * (K[MAIN] + K[0])
    terms[4:0:-1] = h * tableau().D.dot(K)
    return terms


def _between(pieces: list[tuple[Array, Array]]) -> Array:
    """Return the states (n, m) between the ends of the steps, from the terms of each step and the shares (k,)
    of it.
    """
    numbers = np.repeat(np.arange(len(pieces)), [len(shares) for _, shares in pieces])
    (start, *terms), x = (
        np.array([terms for terms, _ in pieces]).swapaxes(0, 1),
        np.concatenate([x for _, x in pieces])[:, None],
    )
    found, shares = np.zeros((len(x), start.shape[1])), (x, 1 - x)
    for number, term in enumerate(terms):
        found += term[numbers]
        found *= shares[number % 2]
    return (found + start[numbers]).T
