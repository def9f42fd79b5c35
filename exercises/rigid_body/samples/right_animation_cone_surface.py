def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    # a solid cone round the symmetry axis with its point at the origin
    h, phi = np.meshgrid(np.linspace(0, 1, 5), np.linspace(0, 2 * np.pi, 25))
    cone = np.array([0.3 * h * np.cos(phi), 0.3 * h * np.sin(phi), h])
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
    u = L / np.linalg.norm(L)
    ax.plot([0, u[0]], [0, u[1]], [0, u[2]], "r", lw=2)
    surf = [None]

    def update(k):
        if surf[0] is not None:
            surf[0].remove()
        X, Y, Z = np.einsum("ij,jab->iab", R[k], cone)
        surf[0] = ax.plot_surface(X, Y, Z, color="tab:blue", alpha=0.6)
        return surf

    return FuncAnimation(fig, update, frames=range(0, len(t), 3), interval=100)
