def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    fig = plt.figure()
    ax = draw.cube_axes(fig.add_subplot(projection="3d"), 1.0)
    draw.arrow(ax, L / np.linalg.norm(L), color="r")
    line = draw.arrow(ax, R[0, :, 2], color="b")

    def forever():
        k = 0
        while True:
            yield k % len(t)
            k += 1

    def update(k):
        x, y, z = R[k, :, 2]
        line.set_data_3d([0, x], [0, y], [0, z])
        return (line,)

    return FuncAnimation(fig, update, frames=forever, cache_frame_data=False)
