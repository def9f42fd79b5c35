def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    # 20 pictures per second, whatever the solver's own times are
    times = list(np.arange(t[0], t[-1], 0.05))

    def e3(time):
        v = np.array([np.interp(time, t, R[:, j, 2]) for j in range(3)])
        return v / np.linalg.norm(v)

    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
    draw.arrow(ax, L / np.linalg.norm(L), color="tab:red")
    line = draw.arrow(ax, R[0, :, 2], color="tab:blue")

    def update(time):
        x, y, z = e3(time)
        line.set_data_3d([0, x], [0, y], [0, z])
        ax.set_title(f"t = {time:.2f} s")

    return FuncAnimation(fig, update, frames=times, interval=50)
