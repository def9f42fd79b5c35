# Exercise 2


def euler_eqs(t, w, I):
    I = np.asarray(I)
    L = I * w
    return np.cross(w, L) / I
