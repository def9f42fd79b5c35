def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    fig, ax = plt.subplots(subplot_kw=dict(projection="3d"))
    ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
    ax.plot(*zip((0, 0, 0), L / np.linalg.norm(L)), c="r")
    (stick,) = ax.plot([], [], [], c="b", lw=3)

    def tips():
        for Rk in R:
            yield Rk[:, 2]

    def update(e3):
        stick.set_data_3d(*zip((0, 0, 0), e3))
        return (stick,)

    return FuncAnimation(fig, update, frames=tips, save_count=len(t), interval=40)
