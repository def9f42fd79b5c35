def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    """Only the tip, as a dot running round the tip of L."""
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    ax.set_xlim3d(-1, 1), ax.set_ylim3d(-1, 1), ax.set_zlim3d(-1, 1)
    Lx, Ly, Lz = L / np.sqrt(L @ L)
    ax.plot([0, Lx], [0, Ly], [0, Lz], c="red")
    dot = ax.scatter([R[0, 0, 2]], [R[0, 1, 2]], [R[0, 2, 2]], s=60, c="blue")

    def move(i):
        x, y, z = R[i, :, 2]
        dot._offsets3d = ([x], [y], [z])
        return [dot]

    return FuncAnimation(fig, move, len(t), interval=40)
