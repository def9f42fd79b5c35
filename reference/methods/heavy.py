"""Numerical methods for the heavy top: Runge-Kutta and splitting, compiled, and SciPy's solvers on (ω, R) and
on Euler angles.
"""

from collections.abc import Callable
from functools import partial

import numpy as np
from numba import njit
from scipy.integrate import solve_ivp

from reference.heavy_top import attitude, euler_angle_rates, omega
from reference.method import STEPS, Array, Method, Run, Scene
from reference.methods import rotation
from reference.methods.adaptive import ATOL, TOLERANCES
from reference.methods.explicit import RK4, advance, keep, rates
from reference.methods.splitting import KAHAN_LI_6, STRANG, SUZUKI4


@njit(cache=True)
def _rates(y: Array, I: Array, mgl: float, out: Array) -> None:
    """Fill ``out`` (12,) with d(ω, R)/dt; the vertical in body axes is R's last row."""
    rates(y, I, out)
    out[0] += mgl * y[10] / I[0]
    out[1] -= mgl * y[9] / I[1]


@njit(cache=True)
def _explicit(
    A: Array,
    b: Array,
    w0: Array,
    R0: Array,
    I: Array,
    mgl: float,
    h: float,
    intervals: int,
    steps: int,
    w: Array,
    R: Array,
) -> int:
    stages = b.size
    y, k, point = np.concatenate((w0, R0.ravel())), np.empty((stages, 12)), np.empty(12)
    keep(y, 0, w, R)
    for at in range(1, intervals + 1):
        for _ in range(steps):
            for s in range(stages):
                advance(y, h, A[s, :s], k, point)
                _rates(point, I, mgl, k[s])
            advance(y, h, b, k, y)
        keep(y, at, w, R)
    return int(intervals * steps * stages)


@njit(cache=True)
def _kick(m: Array, p: Array, impulse: float) -> None:
    """Add the torque times a time, ``impulse`` in N m s, to the momentum m."""
    m[0] += impulse * 2 * (p[2] * p[3] + p[0] * p[1])
    m[1] -= impulse * 2 * (p[1] * p[3] - p[0] * p[2])


@njit(cache=True)
def _splitting(
    gammas: Array,
    w0: Array,
    R0: Array,
    I: Array,
    mgl: float,
    h: float,
    intervals: int,
    steps: int,
    w: Array,
    R: Array,
) -> int:
    m, p = rotation.start(w0, I)
    p[0], p[1] = np.sqrt((1 + R0[2, 2]) / 2), np.sqrt((1 - R0[2, 2]) / 2)
    rotation.keep(m, p, I, 0, w, R)
    for at in range(1, intervals + 1):
        for _ in range(steps):
            for gamma in gammas:
                g = gamma * h
                _kick(m, p, 0.5 * g * mgl)
                # Free motion of the symmetric top: a turn about the constant L, and one about its own axis.
                rotation.turn(m, p, g * m[0] / I[0], g * m[1] / I[0], g * m[2] / I[0])
                rotation.turn(m, p, 0.0, 0.0, g * m[2] * (1 / I[2] - 1 / I[0]))
                _kick(m, p, 0.5 * g * mgl)
            rotation.normalise(p)
        rotation.keep(m, p, I, at, w, R)
    return int(intervals * steps * gammas.size)


def _fixed(name: str, line: str, order: int, kernel: Callable[..., int]) -> Method:
    def run(scene: Scene, setting: float) -> Run:
        steps, n = int(setting), scene.intervals
        w, R = np.empty((n + 1, 3)), np.empty((n + 1, 3, 3))
        calls = kernel(
            np.array(scene.w0),
            scene.R0,
            np.array(scene.I),
            scene.mgl,
            scene.t_end / (n * steps),
            n,
            steps,
            w,
            R,
        )
        return Run(w.T, R, calls)

    return Method(name, line, order, STEPS, run)


def _solve(
    solver: str, rhs: Callable[..., Array], start: Array, scene: Scene, rtol: float
) -> tuple[Array, int]:
    run = solve_ivp(
        rhs, (0.0, scene.t_end), start, method=solver, t_eval=scene.t, rtol=rtol, atol=ATOL * rtol
    )  # type: ignore[call-overload]
    y = np.full((start.size, scene.t.size), np.nan)
    y[:, : run.y.shape[1]] = run.y
    return y, int(run.nfev)


def _matrix(solver: str, scene: Scene, rtol: float) -> Run:
    I, out = np.array(scene.I), np.empty(12)

    def rhs(_: float, y: Array) -> Array:
        _rates(y, I, scene.mgl, out)
        return out.copy()

    y, calls = _solve(solver, rhs, np.concatenate([scene.w0, scene.R0.ravel()]), scene, rtol)
    return Run(y[:3], y[3:].T.reshape(-1, 3, 3), calls)


def euler_angles(scene: Scene, rtol: float) -> Run:
    """Integrate θ, φ, ψ and their rates by DOP853 at ``rtol``."""

    def rhs(_: float, y: Array) -> Array:
        return euler_angle_rates(y, scene.I[0], scene.I[2], scene.mgl)

    y, calls = _solve("DOP853", rhs, np.array(scene.euler_angles), scene, rtol)
    return Run(omega(y), attitude(y[:3]), calls)


def _exact(scene: Scene, _: float) -> Run:
    top = scene.top()
    return Run(top.omega(scene.t), top.attitude(scene.t), 1)


HEAVY = (
    _fixed("RK4", "explicit", 4, partial(_explicit, *RK4)),
    *(
        _fixed(name, "splitting", order, partial(_splitting, gammas))
        for name, order, gammas in (
            ("Strang splitting", 2, STRANG),
            ("splitting 4", 4, SUZUKI4),
            ("splitting 6", 6, KAHAN_LI_6),
        )
    ),
    *(
        Method(solver, "adaptive", None, TOLERANCES, partial(_matrix, solver))
        for solver in ("RK45", "DOP853", "LSODA")
    ),
    Method("Euler angles (DOP853)", "adaptive", None, TOLERANCES, euler_angles),
    Method("exact", "closed form", None, (0.0,), _exact),
)
