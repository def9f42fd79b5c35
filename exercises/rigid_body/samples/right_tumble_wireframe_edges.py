from itertools import combinations, product


def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_tumble(t, R, half):
    corners = np.array(list(product((-1, 1), repeat=3))) * half
    pairs = [(i, j) for i, j in combinations(range(8), 2) if np.sum(corners[i] != corners[j]) == 1]
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    m = np.linalg.norm(half)
    ax.set(xlim=(-m, m), ylim=(-m, m), zlim=(-m, m))
    edges = [ax.plot([], [], [], "k-")[0] for _ in pairs]

    def update(k):
        c = corners @ R[k].T
        for line, (i, j) in zip(edges, pairs):
            line.set_data_3d(*c[[i, j]].T)
        return edges

    return FuncAnimation(fig, update, frames=range(0, len(t), 2), interval=60)
