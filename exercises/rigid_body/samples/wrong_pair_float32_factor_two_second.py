# Ex 2: Euler equations


def euler_eqs(t, w, I):
    x, y, z = np.float32(w)
    a, b, c = np.float32(I)
    return np.array([(b - c) * y * z / a, 2 * (c - a) * z * x / b, (a - b) * x * y / c])
