def euler_eqs(t, w, I):
    I1, I2, I3 = I
    out = np.empty(3)
    out[1] = (I2 - I3) * w[1] * w[2] / I1
    out[0] = (I3 - I1) * w[2] * w[0] / I2
    out[2] = (I1 - I2) * w[0] * w[1] / I3
    return out
