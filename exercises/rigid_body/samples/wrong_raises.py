def helper(w, I):
    return w[3] * I[0]


def euler_eqs(t, w, I):
    return helper(w, I)
