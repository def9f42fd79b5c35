# Exercise 2, torque-free rigid body


def euler_eqs(t, w, I):
    # I2-I3 = -1, I3-I1 = 2, I1-I2 = -1
    return np.array([-w[1] * w[2] / I[0], 2 * w[2] * w[0] / I[1], -w[0] * w[1] / I[2]])
