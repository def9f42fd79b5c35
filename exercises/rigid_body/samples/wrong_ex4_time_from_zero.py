def euler_eqs(t, w, I):
    return np.cross(I * w, w) / I


def precession_rate(t, w):
    phase = np.unwrap(np.arctan2(w[1], w[0]))
    return (phase[-1] - phase[0]) / t[-1]
