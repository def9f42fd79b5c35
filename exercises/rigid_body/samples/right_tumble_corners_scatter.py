def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_tumble(t, R, half):
    signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
    corners = signs * half
    fig, ax = plt.subplots(subplot_kw={"projection": "3d"})
    m = np.linalg.norm(half)
    ax.set(xlim=(-m, m), ylim=(-m, m), zlim=(-m, m))
    dots = ax.scatter(*corners.T, c=range(8), cmap="tab10", s=50, depthshade=False)
    label = ax.text2D(0.05, 0.95, "", transform=ax.transAxes)

    def update(k):
        dots._offsets3d = tuple(np.einsum("ij,cj->ic", R[k], corners))
        label.set_text(f"t = {t[k]:.2f}")
        return dots, label

    return FuncAnimation(fig, update, frames=len(t), interval=40)
