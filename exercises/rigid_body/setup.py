"""The notebook's Setup cell: these names are in scope for every submission."""

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
    """Kinetic energy ½ Σ I ω² for w (3,) or (3, n)."""
    I = np.asarray(I, dtype=float)
    return 0.5 * np.tensordot(I, np.asarray(w) ** 2, axes=1)


def L_body(w, I):
    """Angular momentum (3,) or (3, n) in body axes."""
    return (np.asarray(I, dtype=float) * np.asarray(w).T).T


def integrate_body(euler_eqs, w0, I, t):
    """ω (3, n) and the attitude R (n, 3, 3), body → space, at times t (n,), from ω(0) = w0 and R(0) = 1."""
    t = np.asarray(t, dtype=float)

    def rhs(time, y):
        w1, w2, w3 = y[:3]
        turn = np.array([[0, -w3, w2], [w3, 0, -w1], [-w2, w1, 0]])
        return np.concatenate([euler_eqs(time, y[:3], I), (y[3:].reshape(3, 3) @ turn).ravel()])

    start = np.concatenate([np.asarray(w0, dtype=float), np.eye(3).ravel()])
    run = solve_ivp(rhs, (0.0, t[-1]), start, method="DOP853", t_eval=t, rtol=1e-11, atol=1e-13)
    return run.y[:3], run.y[3:].T.reshape(-1, 3, 3)
