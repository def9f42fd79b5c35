# Exercise 2, torque-free rigid body


def euler_eqs(t, w, I, torque):
    I = np.asarray(I)
    return (torque + np.cross(I * w, w)) / I
