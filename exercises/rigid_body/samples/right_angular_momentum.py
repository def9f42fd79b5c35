def euler_eqs(t, w, I):
    I = np.asarray(I, dtype=float)
    L = I * w
    dL = np.array([L[1] * w[2] - L[2] * w[1], L[2] * w[0] - L[0] * w[2], L[0] * w[1] - L[1] * w[0]])
    return dL / I
