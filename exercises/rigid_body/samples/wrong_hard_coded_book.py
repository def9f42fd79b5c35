def euler_eqs(t, w, I):
    m, a, b, c = 1.0, 2.0, 1.4, 0.4
    I = m / 12 * np.array([b**2 + c**2, a**2 + c**2, a**2 + b**2])
    I1, I2, I3 = I
    return np.array([(I2 - I3) * w[1] * w[2] / I1, (I3 - I1) * w[2] * w[0] / I2, (I1 - I2) * w[0] * w[1] / I3])
