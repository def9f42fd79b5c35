def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    fig, (top, side) = plt.subplots(1, 2, figsize=(8, 4))
    u = L / np.linalg.norm(L)
    for ax, j, name in ((top, 1, "y"), (side, 2, "z")):
        ax.set(xlim=(-1.1, 1.1), ylim=(-1.1, 1.1), aspect="equal", xlabel="x", ylabel=name)
        ax.plot([0, u[0]], [0, u[j]], color="tab:red", label="L")
    (a,) = top.plot([], [], marker="o", label="e3")
    (b,) = side.plot([], [], marker="o", label="e3")
    side.legend(loc="lower right")

    def update(k):
        x, y, z = R[k, :, 2]
        a.set_data([0, x], [0, y])
        b.set_data([0, x], [0, z])
        fig.suptitle(f"t = {t[k]:.2f}")
        return a, b

    return FuncAnimation(fig, update, frames=len(t), interval=40)
