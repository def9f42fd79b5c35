def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    n = L / np.linalg.norm(L)

    def draw_frame(i):
        ax.cla()
        ax.set_xlim(-1, 1)
        ax.set_ylim(-1, 1)
        ax.set_zlim(-1, 1)
        ax.set_title(f"frame {i}/{len(t)}")
        ax.plot([0, n[0]], [0, n[1]], [0, n[2]], "r-", label="L")
        e = R[i, :, 2]
        ax.plot([0, e[0]], [0, e[1]], [0, e[2]], "b-", label="symmetry axis")
        ax.plot(R[:i, 0, 2], R[:i, 1, 2], R[:i, 2, 2], "b:", lw=0.8)
        ax.legend(loc="lower left")

    return FuncAnimation(fig, draw_frame, frames=np.arange(len(t)))
