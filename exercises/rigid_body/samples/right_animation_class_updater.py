def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


class Top:
    """Knows its axis and how to draw itself."""

    def __init__(self, ax, R, L):
        self.R = R
        self.past = []
        ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
        ax.plot(*np.array([[0, 0, 0], L / np.linalg.norm(L)]).T, "r-")
        (self.axis,) = ax.plot([], [], [], "k-", lw=2)
        (self.trail,) = ax.plot([], [], [], "b-", lw=1)

    def __call__(self, i):
        if i == 0:
            self.past = []
        tip = self.R[i] @ [0, 0, 1]
        self.past.append(tip)
        self.axis.set_data_3d(*np.array([[0, 0, 0], tip]).T)
        self.trail.set_data_3d(*np.array(self.past).T)
        return self.axis, self.trail


def animate_precession(t, R, L):
    fig = plt.figure()
    top = Top(fig.add_subplot(projection="3d"), R, L)
    return FuncAnimation(fig, top, frames=len(t), interval=40)
