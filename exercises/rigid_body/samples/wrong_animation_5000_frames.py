def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    fine = np.linspace(t[0], t[-1], 5000)  # really smooth
    e3 = np.array([np.interp(fine, t, R[:, j, 2]) for j in range(3)])
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
    ax.plot(*np.c_[np.zeros(3), L / np.linalg.norm(L)], "r")
    (line,) = ax.plot([], [], [], "b", lw=3)

    def update(k):
        line.set_data_3d(*np.c_[np.zeros(3), e3[:, k]])
        return (line,)

    return FuncAnimation(fig, update, frames=5000, interval=1)
