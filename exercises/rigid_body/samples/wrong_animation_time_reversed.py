def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    tips = R[::-1, :, 2]
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
    ax.plot(*np.c_[np.zeros(3), L / np.linalg.norm(L)], "r")
    (line,) = ax.plot(*np.c_[np.zeros(3), tips[0]], "b", lw=3)

    def update(i):
        line.set_data_3d(*np.c_[np.zeros(3), tips[i]])
        ax.set_title(f"t = {t[i]:.2f} s")
        return (line,)

    return FuncAnimation(fig, update, frames=len(t), interval=40)
