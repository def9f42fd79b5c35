moments = np.array([2.0, 3.0, 4.0])


def euler_eqs(t, w, I):
    return np.cross(w, moments * w) / moments
