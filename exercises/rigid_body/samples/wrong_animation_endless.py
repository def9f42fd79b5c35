import itertools


def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    fig, ax = plt.subplots()
    (line,) = ax.plot([0, 1], [0, 1])

    def update(k):
        line.set_ydata([0, np.sin(k)])

    return FuncAnimation(fig, update, frames=itertools.count(), cache_frame_data=False)
