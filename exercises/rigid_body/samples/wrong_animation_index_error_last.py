def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
    u = L / np.linalg.norm(L)
    ax.plot([0, u[0]], [0, u[1]], [0, u[2]], "r")
    (line,) = ax.plot([], [], [], "b", lw=3)
    (speed,) = ax.plot([], [], [], "g", lw=1)

    def update(k):
        e = R[k, :, 2]
        v = (R[k + 1, :, 2] - e) / (t[k + 1] - t[k])
        line.set_data_3d([0, e[0]], [0, e[1]], [0, e[2]])
        speed.set_data_3d([e[0], e[0] + 0.3 * v[0]], [e[1], e[1] + 0.3 * v[1]], [e[2], e[2] + 0.3 * v[2]])
        return line, speed

    return FuncAnimation(fig, update, frames=len(t), interval=40)
