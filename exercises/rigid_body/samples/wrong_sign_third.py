def euler_eqs(t, w, I):
    L = [I[0] * w[0], I[1] * w[1], I[2] * w[2]]
    a = (L[1] * w[2] - L[2] * w[1]) / I[0]
    b = (L[2] * w[0] - L[0] * w[2]) / I[1]
    c = (L[1] * w[0] - L[0] * w[1]) / I[2]
    return np.array([a, b, c])
