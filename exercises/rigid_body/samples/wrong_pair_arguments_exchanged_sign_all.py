# Exercise 2


def euler_eqs(t, I, w):
    I1, I2, I3 = I
    w1, w2, w3 = w
    return np.array([(I3 - I2) * w2 * w3 / I1, (I1 - I3) * w3 * w1 / I2, (I2 - I1) * w1 * w2 / I3])
