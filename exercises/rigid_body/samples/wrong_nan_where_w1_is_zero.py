def euler_eqs(t, w, I):
    product = w[0] * w[1] * w[2]
    return np.array([(I[1] - I[2]) * (product / w[0]) / I[0], (I[2] - I[0]) * w[2] * w[0] / I[1], (I[0] - I[1]) * w[0] * w[1] / I[2]])
