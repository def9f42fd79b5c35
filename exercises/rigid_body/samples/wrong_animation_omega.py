def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    # the spin in space, from the skew matrix dR/dt Rᵀ
    W = np.gradient(R, t, axis=0, edge_order=2) @ R.transpose(0, 2, 1)
    w = np.array([W[:, 2, 1], W[:, 0, 2], W[:, 1, 0]]).T
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
    u = L / np.linalg.norm(L)
    ax.plot([0, u[0]], [0, u[1]], [0, u[2]], "r")
    (line,) = ax.plot([], [], [], "b", lw=3)

    def update(i):
        x, y, z = w[i] / 3
        line.set_data_3d([0, x], [0, y], [0, z])
        return (line,)

    return FuncAnimation(fig, update, frames=len(t), interval=40)
