def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    fig = plt.figure(figsize=(5, 5))
    ax = fig.add_subplot(projection="3d")
    ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
    u = L / np.linalg.norm(L)
    ax.quiver(0, 0, 0, *u, color="crimson")
    q = ax.quiver(0, 0, 0, *R[0][:, 2], color="navy")

    def update(frame):
        # a 3d quiver cannot be moved, so throw it away and draw a new one
        nonlocal q
        q.remove()
        q = ax.quiver(0, 0, 0, *R[frame][:, 2], color="navy")

    return FuncAnimation(fig, update, frames=len(t), interval=50)
