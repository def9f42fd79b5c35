# Exercise 2, torque-free rigid body


def euler_eqs(t, w, I):
    I = np.asarray(I, dtype=float)
    return (I - np.roll(I, -1)) * np.roll(w, -1) * np.roll(w, -2) / I
