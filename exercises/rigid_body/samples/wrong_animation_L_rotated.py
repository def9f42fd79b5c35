def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    u = L / np.linalg.norm(L)
    fig = plt.figure()
    ax = draw.cube_axes(fig.add_subplot(projection="3d"), 1.0)
    axis = draw.arrow(ax, R[0, :, 2], color="tab:blue", lw=3)
    momentum = draw.arrow(ax, u, color="tab:red", lw=2)

    def update(k):
        # bring both vectors from the body into space
        for line, v in ((axis, [0, 0, 1]), (momentum, u)):
            x, y, z = R[k] @ v
            line.set_data_3d([0, x], [0, y], [0, z])
        return axis, momentum

    return FuncAnimation(fig, update, frames=len(t), interval=40)
