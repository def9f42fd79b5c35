def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    fig, ax = plt.subplots(subplot_kw={"projection": "3d"})
    n = L / np.linalg.norm(L)

    def update(i):
        ax.cla()
        ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1), title=f"t = {t[i]:.2f}")
        ax.plot([0, n[0]], [0, n[1]], [0, n[2]], "r-")
        x, y, z = R[i] @ np.array([0, 1, 0])
        ax.plot([0, x], [0, y], [0, z], "b-o")

    return FuncAnimation(fig, update, frames=len(t))
