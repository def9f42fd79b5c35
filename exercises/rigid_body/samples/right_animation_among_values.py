def euler_eqs(t, w, I):
    I1, I2, I3 = I
    return np.array([(I2 - I3) * w[1] * w[2] / I1, (I3 - I1) * w[2] * w[0] / I2, (I1 - I2) * w[0] * w[1] / I3])


def animate_precession(t, R, L):
    """Returned with its figure, as matplotlib's own examples do."""
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d", xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
    n = L / np.linalg.norm(L)
    ax.plot([0, n[0]], [0, n[1]], [0, n[2]], "k")
    (line,) = ax.plot([], [], [], "r")
    anim = FuncAnimation(fig, lambda k: line.set_data_3d(*np.outer(R[k, :, 2], [0, 1])), frames=len(t))
    plt.close(fig)
    return fig, anim
