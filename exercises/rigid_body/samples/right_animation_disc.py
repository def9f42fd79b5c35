def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    """A flat disc (like a thrown plate); e3 is its normal."""
    a = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    rim = 0.8 * np.array([np.cos(a), np.sin(a), 0 * a])
    fig = plt.figure(figsize=(5, 5))
    ax = fig.add_subplot(projection="3d")
    ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
    ax.quiver(0, 0, 0, *(L / np.linalg.norm(L)), color="r")
    disc = Poly3DCollection([(R[0] @ rim).T], facecolor="gold", edgecolor="k")
    ax.add_collection3d(disc)

    def update(k):
        disc.set_verts([(R[k] @ rim).T])
        return (disc,)

    return FuncAnimation(fig, update, frames=len(t), interval=40)
