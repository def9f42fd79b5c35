# Ex 2: Euler equations


def euler_eqs(t, w, I):
    I1, I2, I3 = I
    z = (I2 - I3) * w[1] * w[2] / I1 + 1j * (I3 - I1) * w[2] * w[0] / I2
    return np.array([z, z.conjugate(), (I1 - I2) * w[0] * w[1] / I3])
