"""The notebook's Setup cell: every submission can use these names."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from scipy.integrate import solve_ivp

import ecp
from ecp import draw, validate
from ecp.animate import show
from ecp.draw import FACE_COLORS, box_polys

__all__ = [
    "FACE_COLORS",
    "FuncAnimation",
    "L_body",
    "Poly3DCollection",
    "T_rot",
    "box_polys",
    "draw",
    "ecp",
    "integrate_body",
    "np",
    "plt",
    "show",
    "solve_ivp",
    "validate",
]


def T_rot(w, I):
    """Return the kinetic energy ½ Σ I ω² in J, () or (n,), of w (3,) or (3, n) and I (3,)."""
    I = np.asarray(I, dtype=float)
    return 0.5 * np.tensordot(I, np.asarray(w) ** 2, axes=1)


def L_body(w, I):
    """Return the angular momentum in kg m²/s, body axes, of w (3,) or (3, n) and I (3,), in the shape of w."""
    return (np.asarray(I, dtype=float) * np.asarray(w).T).T


def integrate_body(w0, I, t_eval, R0=None):
    """Integrate ``euler_eqs``, as it is defined now, and dR/dt = R [ω]× from t_eval[0] to t_eval[-1].

    w0 (3,) is ω at t_eval[0] in rad/s, I (3,) the moments, R0 (3, 3) the attitude there, body → space (default: identity).
    Returns ω (3, n) in body axes and R (n, 3, 3) at the times t_eval (n,). The older order (euler_eqs, w0, I, t) works too.
    """
    if callable(w0):
        equations, w0, I, t_eval, R0 = w0, I, t_eval, R0, None
    else:
        equations = euler_eqs  # noqa: F821
    t_eval = np.asarray(t_eval, dtype=float)

    def rates(t, y):
        w1, w2, w3 = y[:3]
        cross = np.array([[0, -w3, w2], [w3, 0, -w1], [-w2, w1, 0]])
        return np.concatenate([equations(t, y[:3], I), (y[3:].reshape(3, 3) @ cross).ravel()])

    start = np.concatenate([np.asarray(w0, dtype=float), np.ravel(np.eye(3) if R0 is None else R0)])
    span = (t_eval[0], t_eval[-1])
    run = solve_ivp(rates, span, start, method="DOP853", t_eval=t_eval, rtol=1e-11, atol=1e-13)
    return run.y[:3], run.y[3:].T.reshape(-1, 3, 3)
