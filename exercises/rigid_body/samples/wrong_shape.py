def euler_eqs(t, w, I):
    return [(I[1] - I[2]) * w[1] * w[2] / I[0]]
