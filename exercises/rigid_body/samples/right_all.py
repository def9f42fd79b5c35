def euler_eqs(t, w, I):
    I1, I2, I3 = I
    return np.array(
        [
            (I2 - I3) * w[1] * w[2] / I1,
            (I3 - I1) * w[2] * w[0] / I2,
            (I1 - I2) * w[0] * w[1] / I3,
        ]
    )


def box_moments(m, a, b, c):
    return m / 12 * np.array([b**2 + c**2, a**2 + c**2, a**2 + b**2])


def principal_moments(tensor):
    return np.linalg.eigvalsh(tensor)


def precession_rate(t, w):
    phase = np.unwrap(np.arctan2(w[1], w[0]))
    return (phase[-1] - phase[0]) / (t[-1] - t[0])


def animate_precession(t, R, L):
    fig = plt.figure(figsize=(5, 4))
    ax = fig.add_subplot(projection="3d")
    ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(0, 1.5))
    ax.set_axis_off()
    ax.plot(*zip((0, 0, 0), L / np.linalg.norm(L)), color="tab:red", lw=3)
    (axis,) = ax.plot([], [], [], lw=3)
    (trail,) = ax.plot([], [], [], lw=1)

    def update(k):
        axis.set_data_3d(*np.column_stack([np.zeros(3), R[k, :, 2]]))
        trail.set_data_3d(*R[: k + 1, :, 2].T)
        return axis, trail

    anim = FuncAnimation(fig, update, frames=len(t), interval=40, blit=True)
    plt.close(fig)
    ecp.animate.show(anim)
