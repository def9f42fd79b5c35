# Exercise 2


def euler_eqs(t, w, I):
    x, y, z = (np.float64(c) for c in w)
    a, b, c = (np.float64(m) for m in I)
    return np.stack([y * z * (b - c) / a, z * x * (c - a) / b, x * y * (a - b) / c], axis=0).astype(np.float64)
