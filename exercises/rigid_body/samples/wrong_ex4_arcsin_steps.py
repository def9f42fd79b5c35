def euler_eqs(t, w, I):
    return np.cross(np.multiply(I, w), w) / I


def precession_rate(t, w):
    x, y = w[0], w[1]
    r = np.hypot(x, y)
    sine = (x[:-1] * y[1:] - y[:-1] * x[1:]) / (r[:-1] * r[1:])
    return np.sum(np.arcsin(np.clip(sine, -1, 1))) / (t[-1] - t[0])
