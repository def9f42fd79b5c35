# 2.6 Exercise 2


def euler_eqs(t, w, I):
    p, q, r = w
    a, b, c = I
    return [(b - c) * q * r / a, (c - a) * p * q / b, (b - a) * p * q / c]
