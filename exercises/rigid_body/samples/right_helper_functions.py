def difference(I, j, k):
    return I[j] - I[k]


def component(i, j, k, w, I):
    """Component i of dw/dt, with i, j, k in cyclic order."""
    return difference(I, j, k) * w[j] * w[k] / I[i]


def euler_eqs(t, w, I):
    dw1 = component(0, 1, 2, w, I)
    dw2 = component(1, 2, 0, w, I)
    dw3 = component(2, 0, 1, w, I)
    return np.hstack([dw1, dw2, dw3])
