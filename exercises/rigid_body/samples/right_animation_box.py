def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    fig = plt.figure(figsize=(4, 4))
    ax = draw.cube_axes(fig.add_subplot(projection="3d"), 1.0)
    ax.set_axis_off()
    draw.arrow(ax, L / np.linalg.norm(L), color="tab:red")
    box = Poly3DCollection(box_polys(R[0], (0.3, 0.3, 0.6)), facecolors=FACE_COLORS, edgecolors="k")
    ax.add_collection3d(box)

    def update(k):
        box.set_verts(box_polys(R[k], (0.3, 0.3, 0.6)))
        return (box,)

    anim = FuncAnimation(fig, update, frames=len(t))
    plt.close(fig)
    show(anim)
