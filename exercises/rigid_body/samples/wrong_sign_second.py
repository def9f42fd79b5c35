def euler_eqs(t, w, I):
    w1, w2, w3 = w
    I1, I2, I3 = I
    dw1 = (I2 - I3) / I1 * w2 * w3
    dw2 = (I1 - I3) / I2 * w1 * w3
    dw3 = (I1 - I2) / I3 * w1 * w2
    return np.array([dw1, dw2, dw3])
