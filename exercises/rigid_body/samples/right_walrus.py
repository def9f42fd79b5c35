# Exercise 2, torque-free rigid body


def euler_eqs(t, w, I):
    return np.cross((J := np.asarray(I, dtype=float)) * w, w) / J
