"""The right motion outside of the limits of its axes: all that changes for the eye is the title."""

# ends: fail film
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation


def animate_precession(t, R, L):
    fig, ax = plt.subplots()
    ax.set(xlim=(2, 3), ylim=(2, 3))
    u = L / np.linalg.norm(L)
    ax.plot([0, u[0]], [0, u[1]], "r")
    (line,) = ax.plot([], [], "b", lw=3)

    def update(k):
        line.set_data([0, R[k, 0, 2]], [0, R[k, 1, 2]])
        ax.set_title(f"t = {t[k]:.2f} s")
        return (line,)

    return FuncAnimation(fig, update, frames=len(t))


def euler_eqs(t, w, I):
    return -np.cross(w, np.asarray(I) * w) / np.asarray(I)
