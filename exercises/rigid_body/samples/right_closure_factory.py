def make_rhs(I):
    I1, I2, I3 = I
    k = np.array([(I2 - I3) / I1, (I3 - I1) / I2, (I1 - I2) / I3])

    def rhs(t, w):
        return k * np.array([w[1] * w[2], w[2] * w[0], w[0] * w[1]])

    return rhs


def euler_eqs(t, w, I):
    return make_rhs(I)(t, w)
