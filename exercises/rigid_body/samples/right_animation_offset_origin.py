def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    # the top stands on the floor z = 0 at (2, 1), not at the origin
    foot = np.array([2.0, 1.0, 0.0])
    fig, ax = plt.subplots(subplot_kw={"projection": "3d"})
    ax.set(xlim=(1, 3), ylim=(0, 2), zlim=(-1, 1))
    ax.plot(*np.array([foot, foot + L / np.linalg.norm(L)]).T, color="tab:red")
    (pole,) = ax.plot(*np.array([foot, foot + R[0, :, 2]]).T, color="tab:blue", lw=4)

    def update(k):
        pole.set_data_3d(*np.array([foot, foot + R[k, :, 2]]).T)

    anim = FuncAnimation(fig, update, frames=len(t))
    plt.close(fig)
    return anim
