def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    """Turn space until L is vertical and look down on it: e3 must run on a circle."""
    ez = L / np.linalg.norm(L)
    ex = np.cross(np.eye(3)[np.argmin(np.abs(ez))], ez)
    ex /= np.linalg.norm(ex)
    Q = np.array([ex, np.cross(ez, ex), ez])
    p = R[:, :, 2] @ Q.T

    fig, ax = plt.subplots(figsize=(4, 4))
    ax.set(xlim=(-1, 1), ylim=(-1, 1), aspect="equal", title="looking down L")
    ax.plot(0, 0, "r*", ms=12)
    (hand,) = ax.plot([0, p[0, 0]], [0, p[0, 1]], lw=3)
    (path,) = ax.plot(p[:1, 0], p[:1, 1], lw=1)

    def update(k):
        hand.set_data([0, p[k, 0]], [0, p[k, 1]])
        path.set_data(p[: k + 1, 0], p[: k + 1, 1])
        return hand, path

    return FuncAnimation(fig, update, frames=len(t), interval=40, blit=True)
