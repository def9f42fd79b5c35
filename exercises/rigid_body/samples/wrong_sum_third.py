def euler_eqs(t, w, I):
    I1, I2, I3 = I
    wdot = [0, 0, 0]
    wdot[0] = w[1] * w[2] * (I2 - I3) / I1
    wdot[1] = w[2] * w[0] * (I3 - I1) / I2
    wdot[2] = w[0] * w[1] * (I1 + I2) / I3
    return np.array(wdot)
