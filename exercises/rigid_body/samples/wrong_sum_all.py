# Exercise 2


def euler_eqs(t, w, I):
    return np.array([(I[i - 2] + I[i - 1]) * w[i - 2] * w[i - 1] / I[i] for i in range(3)])
