scale = 1.000001


def euler_eqs(t, w, I):
    return scale * np.cross(np.multiply(I, w), w) / np.array(I)
