def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    """Painted pixel by pixel, seen from above: blue e3, red L, white paper."""
    s = np.linspace(-1.1, 1.1, 120)
    X, Y = np.meshgrid(s, s)

    def stroke(x, y):
        along = np.clip((X * x + Y * y) / (x * x + y * y + 1e-12), 0, 1)
        return np.exp(-((X - along * x) ** 2 + (Y - along * y) ** 2) / 0.04**2)

    paper = np.ones((120, 120, 3))
    paper[..., 1:] -= stroke(*(L / np.linalg.norm(L))[:2])[..., None]

    def picture(k):
        p = paper.copy()
        p[..., :2] *= 1 - stroke(R[k, 0, 2], R[k, 1, 2])[..., None]
        return np.clip(p, 0, 1)

    fig, ax = plt.subplots(figsize=(4, 4))
    im = ax.imshow(picture(0), origin="lower", extent=(-1.1, 1.1, -1.1, 1.1))

    def update(k):
        im.set_data(picture(k))
        return (im,)

    return FuncAnimation(fig, update, frames=len(t), interval=40)
