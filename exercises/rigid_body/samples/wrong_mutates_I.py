# Exercise 2


def euler_eqs(t, w, I):
    for k in range(3):
        I[k] = I[k] * w[k]
    return np.cross(I, w) / np.asarray(I)
