def euler_eqs(t, w, I):
    dw = np.array([0, 0, 0])
    dw[0] = (I[1] - I[2]) * w[1] * w[2] / I[0]
    dw[1] = (I[2] - I[0]) * w[2] * w[0] / I[1]
    dw[2] = (I[0] - I[1]) * w[0] * w[1] / I[2]
    return dw
