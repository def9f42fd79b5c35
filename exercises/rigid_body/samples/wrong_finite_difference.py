# dL/dt = L x dH/dL, derivative done numerically
def H(L, I):
    return np.sum(L**2 / (2 * np.asarray(I)))


def euler_eqs(t, w, I):
    I = np.asarray(I, dtype=float)
    L = I * w
    h = 1e-8
    g = np.zeros(3)
    for k in range(3):
        dL = np.zeros(3)
        dL[k] = h
        g[k] = (H(L + dL, I) - H(L, I)) / h
    return np.cross(L, g) / I
