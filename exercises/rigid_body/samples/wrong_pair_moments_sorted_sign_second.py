# Ex 2: Euler equations


def euler_eqs(t, w, I):
    A, B, C = np.sort(I)
    return np.array([(B - C) * w[1] * w[2] / A, (A - C) * w[2] * w[0] / B, (A - B) * w[0] * w[1] / C])
