# 2.6 Exercise 2


def euler_eqs(t, w, I):
    A, B, C = I
    p, q, r = w
    return np.array([(B - C) * q * r / A, (A - C) * p * r / B, (B - A) * p * q / C])
