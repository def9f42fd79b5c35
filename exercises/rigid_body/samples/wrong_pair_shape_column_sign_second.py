def euler_eqs(t, w, I):
    I1, I2, I3 = I
    return np.array([[(I2 - I3) * w[1] * w[2] / I1],
                     [(I1 - I3) * w[2] * w[0] / I2],
                     [(I1 - I2) * w[0] * w[1] / I3]])
