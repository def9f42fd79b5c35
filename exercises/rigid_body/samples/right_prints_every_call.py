def euler_eqs(t, w, I):
    I1, I2, I3 = I
    print("t =", t, " w =", w)
    wd1 = (I2 - I3) * w[1] * w[2] / I1
    wd2 = (I3 - I1) * w[2] * w[0] / I2
    wd3 = (I1 - I2) * w[0] * w[1] / I3
    return np.array([wd1, wd2, wd3])
