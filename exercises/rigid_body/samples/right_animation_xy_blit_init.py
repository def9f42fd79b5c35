def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    fig, ax = plt.subplots()
    ax.set_aspect("equal")
    ax.set_xlim(-1.05, 1.05)
    ax.set_ylim(-1.05, 1.05)
    l = L / np.linalg.norm(L)
    ax.plot([0, l[0]], [0, l[1]], "r", lw=2)
    (rod,) = ax.plot([], [], "b-o")
    (path,) = ax.plot([], [], "c-", lw=1)
    text = ax.text(0.02, 0.95, "", transform=ax.transAxes)

    def init():
        rod.set_data([], [])
        path.set_data([], [])
        text.set_text("")
        return rod, path, text

    def animate(i):
        rod.set_data([0, R[i, 0, 2]], [0, R[i, 1, 2]])
        path.set_data(R[: i + 1, 0, 2], R[: i + 1, 1, 2])
        text.set_text("t = %.2f s" % t[i])
        return rod, path, text

    return FuncAnimation(fig, animate, init_func=init, frames=len(t), interval=25, blit=True)
