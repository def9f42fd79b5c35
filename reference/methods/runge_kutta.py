"""Explicit Runge-Kutta methods: a tableau and one loop, with fixed steps and, for DOP853, with steps that
follow a tolerance, compiled and in SciPy.
"""

from functools import partial
from typing import Any

import numpy as np
from numba import njit
from scipy.integrate import solve_ivp
from scipy.integrate._ivp import dop853_coefficients as dop853

from reference.euler import attitude_rate, euler_rhs
from reference.methods.method import Method, Run, Scene
from reference.methods.states import MATRIX, Array, rates, run_of, start

EULER = (np.zeros((1, 1)), np.array([1.0]))
# Kutta, 1901
RK4 = (
    np.array([[0, 0, 0, 0], [0.5, 0, 0, 0], [0, 0.5, 0, 0], [0, 0, 1.0, 0]]),
    np.array([1, 2, 2, 1]) / 6,
)
# Hairer, Nørsett & Wanner, Solving Ordinary Differential Equations I, §II.5: the eighth-order formula of
# DOP853.
RK8 = (np.ascontiguousarray(dop853.A[:12, :12]), np.ascontiguousarray(dop853.B))
STEPS = (1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0)
TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13)
ATOL = 1e-2  # of rtol, the notebook's proportion
MOST_CALLS = 1_000_000


@njit(cache=True)
def _advance(y: Array, h: float, weights: Array, k: Array, out: Array) -> None:
    """Fill ``out`` with y + h Σ weights·k, summed over as many stages as there are weights."""
    for i in range(y.size):
        total = h - h  # zero, in the precision of h
        for s in range(weights.size):
            total += weights[s] * k[s, i]
        out[i] = y[i] + h * total


@njit(cache=True)
def _orthonormalise(R: Array) -> None:
    """Replace R (9,) by R (3 − RᵀR) / 2, which squares its deviation from a rotation."""
    old = R.copy()
    for i in range(3):
        for j in range(3):
            total = 3 * old[3 * i + j]
            for k in range(3):
                gram = old[k] * old[j] + old[3 + k] * old[3 + j] + old[6 + k] * old[6 + j]
                total -= old[3 * i + k] * gram
            R[3 * i + j] = total / 2


@njit(cache=True)
def _fixed(
    form: int,
    A: Array,
    b: Array,
    y: Array,
    I: Array,
    mgl: float,
    h: float,
    steps: int,
    tidy: bool,
    out: Array,
) -> int:
    stages, k, point = b.size, np.empty((b.size, y.size), y.dtype), np.empty_like(y)
    for at in range(1, len(out)):
        for _ in range(steps):
            for s in range(stages):
                _advance(y, h, A[s, :s], k, point)
                rates(form, point, I, mgl, k[s])
            _advance(y, h, b, k, y)
            if tidy:
                _orthonormalise(y[3:])
        out[at] = y
    return (len(out) - 1) * steps * stages


def fixed(
    tableau: tuple[Array, Array],
    scene: Scene,
    steps: float,
    form: int = MATRIX,
    *,
    tidy: bool = False,
    precision: Any = np.float64,
) -> Run:
    """Run a scene with ``steps`` steps per interval in double or single ``precision``.

    ``tidy`` makes R orthonormal again after each step; it needs the matrix form.
    """
    y = start(scene, form).astype(precision)
    states = np.empty((scene.intervals + 1, y.size), precision)
    states[0] = y
    A, b, I = (np.asarray(part, dtype=precision) for part in (*tableau, scene.I))
    h = precision(scene.t_end / (scene.intervals * steps))
    calls = _fixed(form, A, b, y, I, precision(scene.mgl), h, int(steps), tidy, states)
    return run_of(form, states.astype(float), calls)


@njit(cache=True)
def _adaptive(
    A: Array,
    b: Array,
    E3: Array,
    E5: Array,
    y: Array,
    I: Array,
    mgl: float,
    gap: float,
    rtol: float,
    out: Array,
) -> int:
    """Advance from sample to sample, with the error estimate and step control of Hairer's DOP853."""
    k, new, calls, h = np.empty((13, y.size)), np.empty_like(y), 1, gap
    rates(MATRIX, y, I, mgl, k[0])
    for at in range(1, len(out)):
        left, rejected = gap, False
        while left > 0:
            step = min(h, left)
            for s in range(1, 12):
                _advance(y, step, A[s, :s], k, new)
                rates(MATRIX, new, I, mgl, k[s])
            _advance(y, step, b, k, new)
            rates(MATRIX, new, I, mgl, k[12])
            calls += 12
            fifth = third = 0.0
            for i in range(y.size):
                scale = rtol * (ATOL + max(abs(y[i]), abs(new[i])))
                off5 = off3 = 0.0
                for s in range(13):
                    off5, off3 = off5 + E5[s] * k[s, i], off3 + E3[s] * k[s, i]
                fifth, third = fifth + (off5 / scale) ** 2, third + (off3 / scale) ** 2
            error = step * fifth / np.sqrt((fifth + 0.01 * third) * y.size) if fifth > 0 else 0.0
            factor = 0.9 * max(error, 1e-16) ** -0.125
            if calls > MOST_CALLS:
                out[at:] = np.nan
                return calls
            if error < 1:
                h = max(step * min(10.0, 1.0 if rejected else factor), h if step < h else 0.0)
                left = 0.0 if step == left else left - step
                y[:], k[0], rejected = new, k[12], False
            else:
                h, rejected = step * max(0.2, factor), True
        out[at] = y
    return calls


def adaptive(scene: Scene, rtol: float) -> Run:
    """Run a scene with DOP853 at ``rtol`` and atol = ATOL·rtol; samples are ends of steps."""
    y = start(scene, MATRIX)
    states = np.empty((scene.intervals + 1, 12))
    states[0] = y
    gap = scene.t_end / scene.intervals
    calls = _adaptive(*RK8, dop853.E3, dop853.E5, y, np.array(scene.I), scene.mgl, gap, rtol, states)
    return run_of(MATRIX, states, calls)


def in_scipy(scene: Scene, rtol: float) -> Run:
    """Run a scene as ``adaptive`` does, by SciPy with a right-hand side in Python, as the notebook does."""
    I1, I2, _ = scene.I

    def rhs(_: float, y: Array) -> Array:
        rate = np.concatenate([euler_rhs(y[:3], scene.I), attitude_rate(y[3:].reshape(3, 3), y[:3]).ravel()])
        rate[:2] += scene.mgl * y[10] / I1, -scene.mgl * y[9] / I2
        return rate

    run = solve_ivp(
        rhs, (0.0, scene.t_end), start(scene, MATRIX), "DOP853", scene.t, rtol=rtol, atol=ATOL * rtol
    )
    states = np.full((len(scene.t), 12), np.nan)
    states[: run.y.shape[1]] = run.y.T
    return run_of(MATRIX, states, int(run.nfev))


RUNGE_KUTTA = (
    *(
        Method(name, order, STEPS, partial(fixed, tableau))
        for name, order, tableau in (("Euler", 1, EULER), ("RK4", 4, RK4), ("RK8", 8, RK8))
    ),
    Method("DOP853", None, TOLERANCES, adaptive),
)
