def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    half = np.array([0.35, 0.35, 0.7])
    fig = plt.figure(figsize=(5, 5))
    ax = fig.add_subplot(projection="3d")
    ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1), xlabel="x", ylabel="y", zlabel="z")
    coll = Poly3DCollection(box_polys(R[0], half), facecolors=FACE_COLORS, edgecolor="k", alpha=0.7)
    ax.add_collection3d(coll)
    ax.quiver(0, 0, 0, *(1.2 * L / np.linalg.norm(L)), color="r")

    def update(i):
        coll.set_verts(box_polys(R[i], half))
        ax.set_title("t = %.1f s" % t[i])
        return (coll,)

    anim = FuncAnimation(fig, update, frames=len(t), interval=1000 * (t[1] - t[0]))
    plt.close(fig)
    return anim
