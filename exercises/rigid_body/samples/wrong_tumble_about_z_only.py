def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_tumble(t, R, half):
    m = np.linalg.norm(half)
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    ax.set(xlim=(-m, m), ylim=(-m, m), zlim=(-m, m))
    box = Poly3DCollection(box_polys(np.eye(3), half), facecolors=FACE_COLORS, edgecolors="k")
    ax.add_collection3d(box)

    def update(k):
        # angle of the first edge in the x-y plane
        a = np.arctan2(R[k, 1, 0], R[k, 0, 0])
        Rz = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
        box.set_verts(box_polys(Rz, half))
        return (box,)

    return FuncAnimation(fig, update, frames=len(t), interval=40)
