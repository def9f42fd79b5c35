# Ex 2: Euler equations


def euler_eqs(t, w, I):
    I = np.asarray(I)
    noise = np.random.normal(0, 1e-3, size=3)
    return np.cross(I * w, w) / I + noise
