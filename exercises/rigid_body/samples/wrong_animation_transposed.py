def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    e3 = np.array([0, 0, 1])
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
    u = L / np.linalg.norm(L)
    ax.plot([0, u[0]], [0, u[1]], [0, u[2]], "r")
    (line,) = ax.plot([], [], [], "b", lw=3)

    def update(i):
        x, y, z = R[i].T @ e3
        line.set_data_3d([0, x], [0, y], [0, z])
        return (line,)

    return FuncAnimation(fig, update, frames=len(t), interval=40)
