def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_tumble(t, R, half):
    """Shadow on the x-y plane: a wire box in 2-D, its +e3 face filled."""
    a, b, c = half
    ring = np.array([[a, b], [a, -b], [-a, -b], [-a, b], [a, b]]).T
    upper = np.vstack([ring, np.full(5, c)])
    lower = np.vstack([ring, np.full(5, -c)])
    fig, ax = plt.subplots()
    m = np.linalg.norm(half)
    ax.set(xlim=(-m, m), ylim=(-m, m), aspect="equal", xlabel="x", ylabel="y")
    (face,) = ax.fill(upper[0], upper[1], color="tab:orange", alpha=0.6)
    lines = [ax.plot([], [], "k-")[0] for _ in range(6)]

    def update(k):
        u, l = (R[k] @ upper)[:2], (R[k] @ lower)[:2]
        face.set_xy(u.T)
        lines[0].set_data(*u)
        lines[1].set_data(*l)
        for i in range(4):
            lines[2 + i].set_data([u[0, i], l[0, i]], [u[1, i], l[1, i]])
        return [face, *lines]

    return FuncAnimation(fig, update, frames=len(t), interval=40, blit=True)
