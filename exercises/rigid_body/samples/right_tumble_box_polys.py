def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_tumble(t, R, half):
    reach = np.linalg.norm(half)
    fig = plt.figure(figsize=(4, 4))
    ax = draw.cube_axes(fig.add_subplot(projection="3d"), reach)
    box = Poly3DCollection(box_polys(R[0], half), facecolors=FACE_COLORS, edgecolors="k")
    ax.add_collection3d(box)

    def update(k):
        box.set_verts(box_polys(R[k], half))
        return (box,)

    anim = FuncAnimation(fig, update, frames=len(t), interval=40)
    plt.close(fig)
    ecp.animate.show(anim)
