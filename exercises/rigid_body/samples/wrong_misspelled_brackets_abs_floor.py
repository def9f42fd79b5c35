def euler_eqs(t, w, I):
    I1, I2, I3 = I
    w1, w2, w3 = w
    return np.array([I2 * w2 * w3 - I3 * w2 * w3 / I1, abs(I3 - I1) * w3 * w1 / I2, (I1 - I2) // I3 * w1 * w2])
