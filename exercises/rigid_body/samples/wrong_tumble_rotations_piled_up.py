def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_tumble(t, R, half):
    m = np.linalg.norm(half)
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    ax.set(xlim=(-m, m), ylim=(-m, m), zlim=(-m, m))
    faces = box_polys(np.eye(3), half)
    box = Poly3DCollection(faces, facecolors=FACE_COLORS, edgecolors="k")
    ax.add_collection3d(box)

    def update(k):
        # turn the box on from where it is
        nonlocal faces
        faces = faces @ R[k].T
        box.set_verts(faces)
        return (box,)

    return FuncAnimation(fig, update, frames=len(t), interval=40)
