def euler_eqs(t, w, I):
    I = np.asarray(I)
    return np.cross(I * w, w) / I


def precession_rate(t, w):
    # turn from one sample to the next, as a phasor: never needs an unwrap
    z = w[0] + 1j * w[1]
    turns = np.angle(z[1:] * z[:-1].conj())
    return turns.sum() / (t[-1] - t[0])
