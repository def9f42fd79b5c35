I_body = np.array([1.0, 1.0, 1.6])


def euler_eqs(t, w, I):
    return np.cross(I_body * w, w) / I_body
