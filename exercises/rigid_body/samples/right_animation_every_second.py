def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    n = len(t)
    axis = np.einsum("nij,j->ni", R, [0.0, 0.0, 1.0])
    fig = plt.figure(figsize=(4, 4))
    ax = fig.add_subplot(projection="3d", xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
    ax.plot(*np.c_[np.zeros(3), L / np.linalg.norm(L)], color="tab:red")
    ax.plot(*axis.T, color="0.8", lw=1)
    line = ax.plot(*np.c_[np.zeros(3), axis[0]], color="tab:green")[0]

    def update(i):
        line.set_data_3d(*np.c_[np.zeros(3), axis[i]])
        return (line,)

    # every second frame is smooth enough
    return FuncAnimation(fig, update, frames=range(0, n, 2), interval=60)
