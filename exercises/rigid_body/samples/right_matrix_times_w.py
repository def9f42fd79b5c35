def A(w, I):
    """State-dependent matrix with dw/dt = A(w) w; every product is shared half and half."""
    a = (I[1] - I[2]) / I[0] / 2
    b = (I[2] - I[0]) / I[1] / 2
    c = (I[0] - I[1]) / I[2] / 2
    return np.array([
        [0.0,      a * w[2], a * w[1]],
        [b * w[2], 0.0,      b * w[0]],
        [c * w[1], c * w[0], 0.0     ],
    ])


def euler_eqs(t, w, I):
    return A(w, I).dot(w)
