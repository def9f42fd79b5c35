def euler_eqs(t, w, I):
    I1, I2, I3 = I
    dw1 = (I2 - I3) * omega[1] * omega[2] / I1
    dw2 = (I3 - I1) * omega[2] * omega[0] / I2
    dw3 = (I1 - I2) * omega[0] * omega[1] / I3
    return np.array([dw1, dw2, dw3])
