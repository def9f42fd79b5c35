# 2.6 Exercise 2


def euler_eqs(t, w, I):
    I = np.asarray(I)
    wdot = np.cross(I * w, w) / I
    return np.concatenate([w, wdot])
