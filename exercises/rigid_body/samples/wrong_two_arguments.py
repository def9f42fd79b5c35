# Ex 2: Euler equations


def euler_eqs(w, I):
    I = np.asarray(I)
    return np.cross(I * w, w) / I
