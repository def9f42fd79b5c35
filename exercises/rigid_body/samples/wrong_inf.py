# Exercise 2


def euler_eqs(t, w, I):
    I = np.asarray(I, dtype=float)
    gap = I - np.roll(I, 3)
    return np.cross(I * w, w) / gap
