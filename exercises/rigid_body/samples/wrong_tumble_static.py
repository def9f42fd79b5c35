def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_tumble(t, R, half):
    m = np.linalg.norm(half)
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    ax.set(xlim=(-m, m), ylim=(-m, m), zlim=(-m, m))
    box = Poly3DCollection(box_polys(R[0], half), facecolors=FACE_COLORS, edgecolors="k")
    ax.add_collection3d(box)

    def update(k):
        verts = box_polys(R[0], half)
        box.set_verts(verts)
        return (box,)

    return FuncAnimation(fig, update, frames=len(t), interval=40)
