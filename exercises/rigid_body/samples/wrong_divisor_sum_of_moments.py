# Ex 2: Euler equations


def euler_eqs(t, w, I):
    I = np.asarray(I, dtype=float)
    return np.cross(I * w, w) / I.sum()
