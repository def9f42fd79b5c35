def torque(t, w):
    return np.array([0.0, 0.0, 0.0])  # torque-free


def euler_eqs(t, w, I):
    tau = torque(t, w)
    I1, I2, I3 = I
    return np.array([
        (tau[0] - (I3 - I2) * w[1] * w[2]) / I1,
        (tau[1] - (I1 - I3) * w[2] * w[0]) / I2,
        (tau[2] - (I2 - I1) * w[0] * w[1]) / I3,
    ])
