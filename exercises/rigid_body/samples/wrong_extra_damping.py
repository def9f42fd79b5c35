# 2.6 Exercise 2


def euler_eqs(t, w, I):
    c = 0.05
    I = np.asarray(I, dtype=float)
    return np.cross(I * w, w) / I - c * np.asarray(w)
