def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_tumble(t, R, half):
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    s = max(half) * 1.3

    def update(k):
        ax.cla()
        ax.set_xlim(-s, s)
        ax.set_ylim(-s, s)
        ax.set_zlim(-s, s)
        ax.set_title(f"t = {t[k]:.2f} s")
        ax.add_collection3d(Poly3DCollection(box_polys(R[k], half), facecolors=FACE_COLORS, edgecolors="k", alpha=0.8))
        tip = 1.2 * half[1] * R[k][:, 1]
        ax.plot([0, tip[0]], [0, tip[1]], [0, tip[2]], "r-", lw=2)

    return FuncAnimation(fig, update, frames=len(t))
