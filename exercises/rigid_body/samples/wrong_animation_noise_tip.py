def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    rng = np.random.default_rng(0)
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
    u = L / np.linalg.norm(L)
    ax.plot([0, u[0]], [0, u[1]], [0, u[2]], "r")
    (line,) = ax.plot([], [], [], "b", lw=3)

    def update(i):
        v = rng.normal(size=3)
        v /= np.linalg.norm(v)
        line.set_data_3d([0, v[0]], [0, v[1]], [0, v[2]])
        return (line,)

    return FuncAnimation(fig, update, frames=len(t), interval=40)
