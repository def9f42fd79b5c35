def euler_eqs(t, w, I):
    I1, I2, I3 = I
    w1, w2, w3 = w
    w[0] = (I2 - I3) * w2 * w3 / I1
    w[1] = (I3 - I1) * w3 * w1 / I2
    w[2] = (I1 - I2) * w1 * w2 / I3
    return w
