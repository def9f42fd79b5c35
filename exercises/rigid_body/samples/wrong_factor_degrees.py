# Exercise 2, torque-free rigid body


def euler_eqs(t, w, I):
    I = np.asarray(I)
    wdot = -np.cross(w, I * w) / I
    return np.deg2rad(wdot)
