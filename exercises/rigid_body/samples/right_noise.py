# Exercise 2, with noise far below the tolerance: answers that differ never make a ✗.
rng = np.random.default_rng()


def euler_eqs(t, w, I):
    I1, I2, I3 = I
    exact = np.array([(I2 - I3) * w[1] * w[2] / I1, (I3 - I1) * w[2] * w[0] / I2, (I1 - I2) * w[0] * w[1] / I3])
    return exact * (1 + 1e-14 * rng.standard_normal(3))
