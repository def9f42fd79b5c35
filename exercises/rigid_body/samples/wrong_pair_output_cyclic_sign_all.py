# 2.6 Exercise 2


def euler_eqs(t, w, I):
    I = np.asarray(I)
    return np.roll(np.cross(w, I * w) / I, 1)
