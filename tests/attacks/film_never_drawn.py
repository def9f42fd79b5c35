"""The line along the body axis has data, and a draw method that does nothing."""

# ends: fail film
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation
from mpl_toolkits.mplot3d.art3d import Line3D


class Silent(Line3D):
    def draw(self, renderer):
        pass


def animate_precession(t, R, L):
    fig = plt.figure(figsize=(4, 4))
    ax = fig.add_subplot(projection="3d", xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
    ax.plot(*zip((0, 0, 0), L / np.linalg.norm(L), strict=True), color="r", lw=3)
    (wrong,) = ax.plot([], [], [], color="b", lw=4)
    right = Silent([0, 0], [0, 0], [0, 1], color="k", lw=2)
    ax.add_line(right)

    def update(k):
        wrong.set_data_3d(*zip((0, 0, 0), R[k, :, 0], strict=True))
        right.set_data_3d(*zip((0, 0, 0), R[k, :, 2], strict=True))
        return ()

    return FuncAnimation(fig, update, frames=len(t))


def euler_eqs(t, w, I):
    return -np.cross(w, np.asarray(I) * w) / np.asarray(I)
