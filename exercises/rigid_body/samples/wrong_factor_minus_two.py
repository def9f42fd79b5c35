# 2.6 Exercise 2


def euler_eqs(t, w, I):
    I = np.asarray(I)
    L = I * w
    return (np.cross(w, L) - np.cross(L, w)) / I
