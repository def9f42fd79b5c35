def qmul(a, b):
    """Hamilton product, scalar first."""
    s, u = a[0], a[1:]
    r, v = b[0], b[1:]
    return np.concatenate([[s * r - u @ v], s * v + r * u + np.cross(u, v)])


def euler_eqs(t, w, I):
    I = np.array(I, dtype=float)
    wq = np.concatenate([[0.0], w])          # pure quaternions
    Lq = np.concatenate([[0.0], I * w])
    comm = qmul(Lq, wq) - qmul(wq, Lq)       # [L, w] = 2 L x w
    return comm[1:] / 2 / I
