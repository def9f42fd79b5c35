euler_eqs = lambda t, w, I: [(I[i-2] - I[i-1])*w[i-2]*w[i-1]/I[i] for i in range(3)]


def animate_precession(t, R, L):
    yz, depth = R[:, 1:, 2], R[:, 0, 2]
    n = L / np.linalg.norm(L)
    fig, ax = plt.subplots()
    ax.arrow(0, 0, n[1], n[2], width=0.01, color="k", length_includes_head=True)
    comet = ax.scatter(yz[:1, 0], yz[:1, 1], c=depth[:1], vmin=-1, vmax=1, cmap="coolwarm")
    ax.set(xlim=(-1.1, 1.1), ylim=(-1.1, 1.1), aspect="equal")

    def update(k):
        tail = slice(max(0, k - 10), k + 1)
        comet.set_offsets(yz[tail])
        comet.set_array(depth[tail])
        comet.set_sizes(np.linspace(5, 60, len(depth[tail])))
        return comet,

    return FuncAnimation(fig, update, frames=len(t), init_func=lambda: (comet,), blit=True)
