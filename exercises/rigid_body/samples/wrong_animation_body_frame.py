def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    # sitting on the body: its axis stays upright and L goes round
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
    ax.plot([0, 0], [0, 0], [0, 1], "b", lw=3, label="e3")
    (arrow,) = ax.plot([], [], [], "r", lw=2, label="L")
    ax.legend()

    def update(i):
        x, y, z = R[i].T @ L / np.linalg.norm(L)
        arrow.set_data_3d([0, x], [0, y], [0, z])
        return (arrow,)

    return FuncAnimation(fig, update, frames=len(t), interval=40)
