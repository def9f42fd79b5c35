m, g, l = 0.1, 9.81, 0.05


def euler_eqs(t, w, I):
    I1, I2, I3 = I
    r = np.array([0.0, 0.3, 1.0]) * l
    tau = np.cross(r, [0.0, 0.0, -m * g])
    d1 = (tau[0] + (I2 - I3) * w[1] * w[2]) / I1
    d2 = (tau[1] + (I3 - I1) * w[2] * w[0]) / I2
    d3 = (tau[2] + (I1 - I2) * w[0] * w[1]) / I3
    return np.array([d1, d2, d3])
