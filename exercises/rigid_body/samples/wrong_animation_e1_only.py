def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    # symmetry axis = first column
    axis = R[:, :, 0]
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
    ax.quiver(0, 0, 0, *(L / np.linalg.norm(L)), color="r")
    (line,) = ax.plot([0, axis[0, 0]], [0, axis[0, 1]], [0, axis[0, 2]], "b", lw=3)

    def update(k):
        line.set_data_3d(*np.array([[0, 0, 0], axis[k]]).T)
        return (line,)

    return FuncAnimation(fig, update, frames=len(t), interval=40)
