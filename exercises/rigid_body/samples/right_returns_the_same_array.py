import numpy as np

rates = np.zeros(3)


def euler_eqs(t, w, I):
    rates[0] = (I[1] - I[2]) * w[1] * w[2] / I[0]
    rates[1] = (I[2] - I[0]) * w[2] * w[0] / I[1]
    rates[2] = (I[0] - I[1]) * w[0] * w[1] / I[2]
    return rates
