def euler_eqs(t, w, I):
    a = (I[1] - I[2]) * w[1] * w[2] / 2
    b = (I[2] - I[0]) * w[2] * w[0] / 3
    c = (I[0] - I[1]) * w[0] * w[1] / 4
    return np.array([a, b, c])
