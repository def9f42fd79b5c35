def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    fig = plt.figure()
    ax = draw.cube_axes(fig.add_subplot(projection="3d"), 1.0)
    draw.arrow(ax, L / np.linalg.norm(L), color="red", lw=2)
    # a bit shorter than L, so that both tips can be seen
    e3 = draw.arrow(ax, 0.8 * R[0, :, 2], color="black", lw=4)

    def update(k):
        x, y, z = 0.8 * R[k, :, 2]
        e3.set_data_3d((0, x), (0, y), (0, z))

    anim = FuncAnimation(fig, update, frames=len(t), interval=1000 * t[-1] / len(t))
    plt.close(fig)
    ecp.animate.show(anim)
