# Ex 2: Euler equations


def euler_eqs(t, w, I):
    w1, w2, w3 = w
    I1, I2, I3 = I
    return np.array([(I2 - I3) * w1 * w2 / I1, (I3 - I1) * w3 * w1 / I2, (I1 - I2) * w1 * w2 / I3])
