def euler_eqs(t, w, I):
    a = -(I[2] - I[1]) / I[0]
    b = -(I[0] - I[2]) / I[1]
    c = -(I[1] - I[0]) / I[2]
    return [a * w[1] * w[2], b * w[0] * w[2], c * w[0] * w[1]]
