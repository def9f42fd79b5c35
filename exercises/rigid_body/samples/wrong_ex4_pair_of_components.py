def euler_eqs(t, w, I):
    return np.cross(I * w, w) / I


def precession_rate(t, w):
    return np.polyfit(t, np.unwrap(np.arctan2(w[2], w[0])), 1)[0]
