# Exercise 2


def euler_eqs(t, w, I):
    I = np.asarray(I)
    L = 2 * I * w
    return np.cross(L, w)
