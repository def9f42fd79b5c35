from matplotlib.animation import ArtistAnimation


def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    ax.set_xlim(-1, 1)
    ax.set_ylim(-1, 1)
    ax.set_zlim(-1, 1)
    Lu = L / np.linalg.norm(L)
    ax.plot([0, Lu[0]], [0, Lu[1]], [0, Lu[2]], "r-")
    ims = []
    for k in range(len(t)):
        x, y, z = R[k, :, 2]
        line = ax.plot([0, x], [0, y], [0, z], "b-", lw=2)
        point = ax.plot([x], [y], [z], "bo")
        ims.append(line + point)
    return ArtistAnimation(fig, ims, interval=50, repeat=False)
