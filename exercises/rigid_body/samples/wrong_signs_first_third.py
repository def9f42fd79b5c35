# Exercise 2, torque-free rigid body


def euler_eqs(t, w, I):
    I1, I2, I3 = I
    return [(I3 - I2) / I1 * w[1] * w[2], (I3 - I1) / I2 * w[2] * w[0], (I2 - I1) / I3 * w[0] * w[1]]
