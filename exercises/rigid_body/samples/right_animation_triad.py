def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
    n = L / np.linalg.norm(L)
    ax.plot([0, n[0]], [0, n[1]], [0, n[2]], color="black", ls="--", label="L")
    lines = []
    for name, color in zip(("e1", "e2", "e3"), ("tab:red", "tab:green", "tab:blue")):
        lines.append(ax.plot([], [], [], color=color, label=name)[0])
    ax.legend()

    def update(k):
        for j in range(3):
            v = R[k][:, j]
            lines[j].set_data([0, v[0]], [0, v[1]])
            lines[j].set_3d_properties([0, v[2]])
        return lines

    anim = FuncAnimation(fig, update, frames=len(t), interval=40)
    plt.close(fig)
    return anim
