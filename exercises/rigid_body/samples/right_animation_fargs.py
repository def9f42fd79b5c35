def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def redraw(num, data, line, shadow):
    x, y, z = data[num]
    line.set_data([0, x], [0, y])
    line.set_3d_properties([0, z])
    shadow.set_data([0, x], [0, y])
    shadow.set_3d_properties([-1, -1])
    return line, shadow


def animate_precession(t, R, L):
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    ax.set(xlim3d=(-1, 1), ylim3d=(-1, 1), zlim3d=(-1, 1))
    u = L / np.linalg.norm(L)
    ax.plot([0, u[0]], [0, u[1]], [0, u[2]], color="red")
    (line,) = ax.plot([0, 0], [0, 0], [0, 1], color="blue")
    (shadow,) = ax.plot([0, 0], [0, 0], [-1, -1], color="lightgray")
    data = R[:, :, 2].copy()
    return FuncAnimation(fig, redraw, len(t), fargs=(data, line, shadow), interval=50, blit=False)
