def euler_eqs(t, w, I):
    I1, I2, I3 = I
    dw1 = (I2 - I3) * w[1] * w[2] / I1
    dw2 = (I3 - I1 * w[2] * w[0] / I2
    dw3 = (I1 - I2) * w[0] * w[1] / I3
    return np.array([dw1, dw2, dw3])
