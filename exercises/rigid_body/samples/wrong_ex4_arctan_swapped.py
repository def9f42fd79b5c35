def euler_eqs(t, w, I):
    return np.cross(np.multiply(I, w), w) / I


def precession_rate(t, w):
    phase = np.unwrap(np.arctan2(w[0], w[1]))
    return np.polyfit(t, phase, 1)[0]
