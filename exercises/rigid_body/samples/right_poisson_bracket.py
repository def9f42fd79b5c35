"""Lie-Poisson: dL/dt = {L, H} = L x grad H, gradient by complex step (no round-off, h can be tiny)."""


def energy(L, I):
    return sum(Lk * Lk / (2 * Ik) for Lk, Ik in zip(L, I))


def grad(f, x, h=1e-30):
    g = np.zeros(3)
    for k in range(3):
        z = np.array(x, dtype=complex)
        z[k] += 1j * h
        g[k] = f(z).imag / h
    return g


def euler_eqs(t, w, I):
    I = np.asarray(I, dtype=float)
    L = I * w
    return np.cross(L, grad(lambda x: energy(x, I), L)) / I
