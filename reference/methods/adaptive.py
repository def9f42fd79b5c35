"""SciPy's adaptive integrators on (ω, R), as the notebook uses them, and one on Euler angles, to show gimbal
lock.
"""

from functools import partial

import numpy as np
from scipy.integrate import solve_ivp

from reference.euler import euler_rhs
from reference.method import Array, Method, Run, Scene

TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13)
ATOL = 1e-2  # of rtol, the notebook's proportion
TILT = 1.0  # rad: Euler angles cannot start upright


def _matrix(solver: str, scene: Scene, rtol: float) -> Run:
    I = scene.I

    def rates(_: float, y: Array) -> Array:
        w1, w2, w3 = y[:3]
        turn = np.array([[0.0, -w3, w2], [w3, 0.0, -w1], [-w2, w1, 0.0]])
        return np.concatenate([euler_rhs(y[:3], I), (y[3:].reshape(3, 3) @ turn).ravel()])

    y, calls = _solve(solver, rates, np.concatenate([scene.w0, np.eye(3).ravel()]), scene, rtol)
    return Run(y[:3], y[3:].T.reshape(-1, 3, 3), calls)


def euler_angles(scene: Scene, rtol: float, tilt: float = TILT) -> Run:
    """Integrate with Euler angles φ, θ, ψ about z, x, z at ``rtol``.

    The start is tilted by ``tilt`` rad about x, and the tilt is removed from the result.
    """
    I = scene.I

    def rates(_: float, y: Array) -> Array:
        (w1, w2, w3), theta, psi = y[:3], y[4], y[5]
        swing = (w1 * np.sin(psi) + w2 * np.cos(psi)) / np.sin(theta)
        nod = w1 * np.cos(psi) - w2 * np.sin(psi)
        return np.array([*euler_rhs(y[:3], I), swing, nod, w3 - swing * np.cos(theta)])

    y, calls = _solve("DOP853", rates, np.array([*scene.w0, 0.0, tilt, 0.0]), scene, rtol)
    attitude = _about_z(y[3]) @ _about_x(y[4]) @ _about_z(y[5])
    return Run(y[:3], _about_x(np.array([tilt])).transpose(0, 2, 1) @ attitude, calls)


def _solve(solver: str, rates, start: Array, scene: Scene, rtol: float) -> tuple[Array, int]:  # type: ignore[no-untyped-def]
    run = solve_ivp(
        rates, (0.0, scene.t_end), start, method=solver, t_eval=scene.t, rtol=rtol, atol=ATOL * rtol
    )  # type: ignore[call-overload]
    y = np.full((start.size, scene.t.size), np.nan)
    y[:, : run.y.shape[1]] = run.y
    return y, int(run.nfev)


def _about_z(angle: Array) -> Array:
    c, s, o = np.cos(angle), np.sin(angle), np.zeros_like(angle)
    return np.array([[c, -s, o], [s, c, o], [o, o, o + 1]]).transpose(2, 0, 1)


def _about_x(angle: Array) -> Array:
    c, s, o = np.cos(angle), np.sin(angle), np.zeros_like(angle)
    return np.array([[o + 1, o, o], [o, c, -s], [o, s, c]]).transpose(2, 0, 1)


# Radau needs three times the steps for each digit: below 1e-8 it would take minutes.
ADAPTIVE = (
    *(
        Method(solver, "adaptive", None, TOLERANCES, partial(_matrix, solver))
        for solver in ("RK45", "DOP853", "LSODA")
    ),
    Method("Radau", "adaptive", None, (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8), partial(_matrix, "Radau")),
    Method("Euler angles (DOP853)", "adaptive", None, TOLERANCES, euler_angles),
)
