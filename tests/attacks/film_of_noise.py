"""Film: as many points and frames as are accepted, all at random, so that every way to explain them is tried."""

# ends: fail film
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation


def animate_precession(t, R, L):
    rng = np.random.default_rng(1)
    fig = plt.figure(figsize=(2, 2))
    ax = fig.add_axes([0, 0, 1, 1], xlim=(-1, 1), ylim=(-1, 1))
    lines = [ax.plot(rng.normal(size=32), rng.normal(size=32), lw=0.5)[0] for _ in range(8)]

    def update(k):
        for line in lines:
            line.set_data(rng.normal(size=32), rng.normal(size=32))
        return ()

    return FuncAnimation(fig, update, frames=600)


def euler_eqs(t, w, I):
    return -np.cross(w, np.asarray(I) * w) / np.asarray(I)
