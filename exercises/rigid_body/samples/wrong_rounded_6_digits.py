# Ex 2: Euler equations


def euler_eqs(t, w, I):
    I = np.asarray(I)
    return np.round(np.cross(I * w, w) / I, 6)
