# 2.6 Exercise 2


def euler_eqs(t, w, I):
    I1, I2, I3 = I
    ww = w[1] * w[2]
    return np.array([(I2 - I3) * ww / I1, (I3 - I1) * ww / I2, (I1 - I2) * ww / I3])
