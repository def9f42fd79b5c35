def euler_eqs(t, w, I):
    I1, I2, I3 = I
    x, y, z = w
    w[0] = (I2 - I3) * y * z / I1
    w[1] = (I3 - I1) * z * x / I3
    w[2] = (I1 - I2) * x * y / I3
    return w
