def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    tip = R[:, :, 2].T  # (3, n)
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    draw.cube_axes(ax, 1.1)
    draw.arrow(ax, L / np.linalg.norm(L), color="k", lw=2)
    (rod,) = ax.plot([], [], [], "o-", color="tab:blue")
    (trail,) = ax.plot([], [], [], color="tab:orange", lw=1)
    label = ax.text2D(0.05, 0.95, "", transform=ax.transAxes)

    def update(k):
        x, y, z = tip[:, k]
        rod.set_data_3d([0, x], [0, y], [0, z])
        trail.set_data_3d(*tip[:, : k + 1])
        label.set_text(f"t = {t[k]:.2f}")
        return rod, trail, label

    return FuncAnimation(fig, update, frames=len(t), interval=30, blit=False)
