def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    """Seen from above, drawn anew for every frame: slow, and right."""
    fig, ax = plt.subplots(figsize=(4, 4))

    def update(k):
        ax.cla()
        ax.set(xlim=(-1, 1), ylim=(-1, 1), aspect="equal", title=f"t = {t[k]:.2f} s")
        ax.plot(*R[: k + 1, :2, 2].T, color="0.6")
        ax.plot([0, R[k, 0, 2]], [0, R[k, 1, 2]], marker="o")
        ax.plot([0, L[0] / np.linalg.norm(L)], [0, L[1] / np.linalg.norm(L)], color="tab:red")

    return FuncAnimation(fig, update, frames=range(0, len(t), 4))
