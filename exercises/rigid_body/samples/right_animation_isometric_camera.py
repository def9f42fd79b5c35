def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    # my own camera: seen from (1, 1, 1), because mplot3d is slow
    camera = np.array([[-1, 1, 0], [-1, -1, 2]]) / np.array([[np.sqrt(2)], [np.sqrt(6)]])
    tip = R[:, :, 2] @ camera.T
    l = camera @ L / np.linalg.norm(L)
    fig, ax = plt.subplots()
    ax.set(xlim=(-1.1, 1.1), ylim=(-1.1, 1.1), aspect="equal")
    ax.axis("off")
    for x, y in camera.T:
        ax.plot([0, x], [0, y], color="0.8", lw=1)
    ax.plot([0, l[0]], [0, l[1]], color="tab:red", lw=2)
    (rod,) = ax.plot([0, tip[0, 0]], [0, tip[0, 1]], color="tab:blue", lw=3)

    def update(k):
        rod.set_data([0, tip[k, 0]], [0, tip[k, 1]])
        return (rod,)

    return FuncAnimation(fig, update, frames=len(t), interval=30, blit=True)
