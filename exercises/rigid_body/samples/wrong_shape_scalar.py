# Exercise 2, torque-free rigid body


def euler_eqs(t, w, I):
    I = np.asarray(I)
    wdot = np.cross(I * w, w) / I
    return np.sqrt(wdot @ wdot)
