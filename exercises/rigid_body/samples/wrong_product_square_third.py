def euler_eqs(t, w, I):
    I1, I2, I3 = I
    dw = np.empty(3)
    dw[0] = (I2 - I3) * w[1] * w[2] / I1
    dw[1] = (I3 - I1) * w[0] * w[2] / I2
    dw[2] = (I1 - I2) * w[0] * w[0] / I3
    return dw
