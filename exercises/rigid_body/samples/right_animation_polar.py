euler_eqs = lambda t, w, I: [(I[i-2] - I[i-1])*w[i-2]*w[i-1]/I[i] for i in range(3)]


def animate_precession(t, R, L):
    z = L / np.linalg.norm(L)
    x = R[0, :, 2] - (R[0, :, 2] @ z) * z
    x /= np.linalg.norm(x)
    y = np.cross(z, x)
    e3 = R[:, :, 2]
    phi = np.unwrap(np.arctan2(e3 @ y, e3 @ x))
    sin_theta = np.hypot(e3 @ x, e3 @ y)
    fig, ax = plt.subplots(subplot_kw=dict(projection="polar"))
    ax.set_rmax(1.2 * sin_theta.max())
    ax.set_title("symmetry axis seen from the tip of L (centre)")
    needle, = ax.plot([0, phi[0]], [0, sin_theta[0]], "o-")

    def update(i):
        needle.set_data([0, phi[i]], [0, sin_theta[i]])
        return needle,

    return FuncAnimation(fig, update, frames=len(t), blit=True)
