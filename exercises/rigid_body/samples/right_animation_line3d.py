def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    # the symmetry axis as a line from the origin to its tip
    fig = plt.figure()
    ax = fig.add_subplot(111, projection="3d")
    ax.set_xlim(-1, 1)
    ax.set_ylim(-1, 1)
    ax.set_zlim(-1, 1)
    Lhat = L / np.linalg.norm(L)
    ax.plot([0, Lhat[0]], [0, Lhat[1]], [0, Lhat[2]], "r--", label="L")
    (axis,) = ax.plot([0, 0], [0, 0], [0, 1], "b-", lw=3, label="e3")
    ax.legend()

    def update(i):
        e3 = R[i] @ np.array([0, 0, 1])
        axis.set_data([0, e3[0]], [0, e3[1]])
        axis.set_3d_properties([0, e3[2]])
        return (axis,)

    return FuncAnimation(fig, update, frames=len(t), interval=40)
