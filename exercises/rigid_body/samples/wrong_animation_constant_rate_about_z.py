def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    # the axis goes round z with a fixed tilt, as in the lecture
    rate, tilt = 2.0, np.radians(25)
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
    u = L / np.linalg.norm(L)
    ax.plot([0, u[0]], [0, u[1]], [0, u[2]], "r")
    (line,) = ax.plot([], [], [], "b", lw=3)

    def update(i):
        x = np.sin(tilt) * np.cos(rate * t[i])
        y = np.sin(tilt) * np.sin(rate * t[i])
        line.set_data_3d([0, x], [0, y], [0, np.cos(tilt)])
        return (line,)

    return FuncAnimation(fig, update, frames=len(t), interval=40)
