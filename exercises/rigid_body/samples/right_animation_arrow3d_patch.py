def euler_eqs(t, w, I):
    I = np.asarray(I)
    return np.cross(I * w, w) / I


from matplotlib.patches import FancyArrowPatch
from mpl_toolkits.mplot3d import proj3d


class Arrow3D(FancyArrowPatch):
    """The well-known answer from StackOverflow."""

    def __init__(self, tip, **kw):
        super().__init__((0, 0), (0, 0), mutation_scale=20, arrowstyle="-|>", **kw)
        self.tip = tip

    def do_3d_projection(self, renderer=None):
        xs, ys, zs = proj3d.proj_transform((0, self.tip[0]), (0, self.tip[1]), (0, self.tip[2]), self.axes.M)
        self.set_positions((xs[0], ys[0]), (xs[1], ys[1]))
        return np.min(zs)


def animate_precession(t, R, L):
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
    ax.add_artist(Arrow3D(L / np.linalg.norm(L), color="red"))
    axis = Arrow3D(R[0, :, 2], color="blue")
    ax.add_artist(axis)

    def update(i):
        axis.tip = R[i, :, 2]
        return (axis,)

    return FuncAnimation(fig, update, frames=len(t), interval=30)
